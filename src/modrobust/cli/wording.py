"""What the library says of keys and arguments, said of options."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

_OPTIONS = (
    (re.compile(r"\block: \{([^{}:]+): ([^{}]+)\}"), r"--lock \1=\2"),
    (re.compile(r"\bbase_link: (\S+)$"), r"--base \1"),
    (re.compile(r'\binertia_about "(\w+)" or "(\w+)"'), r"--inertia-about \1|\2"),
    (re.compile(r'\binertia_about "(\w+)"'), r"--inertia-about \1"),
    (re.compile(r"\bgive a tolerance such as"), "give --tolerance"),
    (re.compile(r"\bsave a video of it$"), "make a video with --video run.mp4"),
)


def as_options(text: str) -> str:
    """The text with the remedies that an option is for written as that option."""
    for pattern, option in _OPTIONS:
        text = pattern.sub(option, text)
    return text


@contextmanager
def named_as_options(*names: str, remedies: bool = False) -> Iterator[None]:
    """Arguments at fault are named as the options that gave them.

    Args:
        names: The arguments that are options.
        remedies: Whether every message speaks of options, not only those about `names`.
    """
    from modrobust.errors import (
        DescriptionError,
        MissingExtraError,
        SeveralFaultsError,
        ValueRangeError,
    )

    def said(text: str) -> str:
        return as_options(text) if remedies else text

    def named(error: DescriptionError) -> DescriptionError:
        if error.file not in names or error.line is not None:
            return DescriptionError(error.file, error.line, error.field, said(error.message))
        field = re.sub(rf"^{error.file}(_link)?(\.|$)", "", error.field)
        return DescriptionError(_option(error.file), None, field, error.message)

    try:
        yield
    except SeveralFaultsError as error:
        raise SeveralFaultsError([named(fault) for fault in error.faults], error.overlay) from None
    except DescriptionError as error:
        raise named(error) from None
    except ValueRangeError as error:
        name, _, rest = str(error).partition(":")
        argument = re.split(r"[.\[]", name)[0]  # payload.com[0] is of the argument payload
        if argument not in names or type(error) is not ValueRangeError:
            raise
        raise ValueRangeError(f"{_option(argument)}{name.removeprefix(argument)}:{rest}") from None
    except MissingExtraError as error:
        raise MissingExtraError(said(str(error))) from None


def _option(argument: str) -> str:
    return f"--{argument.replace('_', '-')}"
