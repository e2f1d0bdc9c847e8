"""Runs of a campaign in processes of their own; who gets which run changes nothing about it.

A worker is a fresh interpreter that reads the job once, then numbers of runs from its standard
input, and answers with records. It imports nothing of the caller's program, so that scripts and
notebooks need no guard; it is out of reach of the terminal's Ctrl-C; it ends when its input does,
that is when the parent has ended, however that was.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable, Sequence
from typing import IO, Any

from modrobust.campaign.figures import Record
from modrobust.campaign.job import Job
from modrobust.errors import ModrobustError

_PROGRAM = "from modrobust.campaign.workers import serve; serve()"
_LOOK = 0.2  # [s], between two looks at the keyboard

Done = Callable[[Record], None]


def processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def run_all(job: Job, indices: Sequence[int], jobs: int, done: Done) -> None:
    """Do the runs; Ctrl-C ends them early, once what was done is handed over.

    Args:
        job: What all of them share.
        indices: Numbers of the runs.
        jobs: Processes; 1 = this one alone.
        done: Is given each record, in the order in which they come.

    Raises:
        ModrobustError: A run was refused, or its process ended twice.
        KeyboardInterrupt: By Ctrl-C.
    """
    if min(jobs, len(indices)) > 1:
        _share(job, indices, min(jobs, len(indices)), done)
        return
    for index in indices:
        done(job.record(index))


def _share(job: Job, indices: Sequence[int], jobs: int, done: Done) -> None:
    """Hand the runs out to as many workers, one at a time."""
    packed = pickle.dumps(job)
    waiting: queue.SimpleQueue[int] = queue.SimpleQueue()
    for index in indices:
        waiting.put(index)
    answers: queue.Queue[Record | BaseException] = queue.Queue()
    workers = [_Worker(packed, waiting, answers) for _ in range(jobs)]
    try:
        for worker in workers:
            worker.start()
        for _ in indices:
            done(_next(answers))
    except KeyboardInterrupt:
        with contextlib.suppress(queue.Empty):  # what came in meanwhile is kept
            while isinstance(answer := answers.get_nowait(), Record):
                done(answer)
        raise
    finally:
        for worker in workers:
            worker.end()


def _next(answers: queue.Queue[Record | BaseException]) -> Record:
    while True:
        try:
            answer = answers.get(timeout=_LOOK)  # not for ever: Ctrl-C is seen between two
        except queue.Empty:
            continue
        if isinstance(answer, BaseException):
            raise answer
        return answer


class _Worker(threading.Thread):
    """Feeds one process, and replaces it once a run where it ends by itself."""

    def __init__(
        self,
        packed: bytes,
        waiting: queue.SimpleQueue[int],
        answers: queue.Queue[Record | BaseException],
    ) -> None:
        super().__init__(daemon=True)
        self._packed, self._waiting, self._answers = packed, waiting, answers
        self._process: subprocess.Popen[bytes] | None = None
        self._over = threading.Event()

    def run(self) -> None:
        """Until no run waits, or `end` is called."""
        try:
            while not self._over.is_set():
                try:
                    index = self._waiting.get_nowait()
                except queue.Empty:
                    break
                self._answers.put(self._record(index))
        except BaseException as problem:  # the parent raises it
            if not self._over.is_set():
                self._answers.put(problem)
        finally:
            self._drop()

    def end(self) -> None:
        """Stop at once, whatever is under way."""
        self._over.set()
        if self._process is not None:
            self._process.kill()
        self.join()

    def _record(self, index: int) -> Record:
        for attempt in (1, 2):
            if self._over.is_set():
                raise KeyboardInterrupt
            process = self._process or self._begin()
            try:
                kind, answer = _asked(process, index)
            except (EOFError, OSError, pickle.UnpicklingError):
                code = process.wait()
                self._drop()
                if attempt == 2 and not self._over.is_set():
                    raise ModrobustError(
                        f"run {index}: its process ended twice, with exit code {code}; give fewer "
                        "jobs if the memory is short"
                    ) from None
                continue
            if kind == "record":
                assert isinstance(answer, Record)
                return answer
            raise answer if isinstance(answer, BaseException) else RuntimeError(answer)
        raise KeyboardInterrupt

    def _begin(self) -> subprocess.Popen[bytes]:
        self._process = process = subprocess.Popen(
            [sys.executable, "-P", "-c", _PROGRAM],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={
                "OPENBLAS_NUM_THREADS": "1",  # the processors are taken
                **os.environ,
                "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
            },
            start_new_session=True,
        )
        if self._over.is_set():
            process.kill()
        assert process.stdin is not None
        process.stdin.write(self._packed)
        return process

    def _drop(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        process.wait()
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                with contextlib.suppress(OSError):  # what was not yet written to a dead process
                    stream.close()


def _asked(process: subprocess.Popen[bytes], index: int) -> tuple[str, Any]:
    assert process.stdin is not None
    assert process.stdout is not None
    pickle.dump(index, process.stdin)
    process.stdin.flush()
    answer: tuple[str, Any] = pickle.load(process.stdout)
    return answer


def serve() -> None:
    """What a worker does: a job, then numbers of runs, until the input ends."""
    numbers = sys.stdin.buffer
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what an engine prints is no answer
    try:
        job = pickle.load(numbers)
        while True:
            _answer(job, pickle.load(numbers), answers)
    except (EOFError, BrokenPipeError):
        return


def _answer(job: Job, index: int, answers: IO[bytes]) -> None:
    try:
        text = pickle.dumps(("record", job.record(index)))
    except Exception as problem:
        text = _packed_problem(problem)
    answers.write(text)
    answers.flush()


def _packed_problem(problem: Exception) -> bytes:
    """The exception, or its trace where it cannot travel."""
    try:
        text = pickle.dumps(("problem", problem))
        pickle.loads(text)
    except Exception:
        text = pickle.dumps(("problem", traceback.format_exc()))
    return text
