// Binding of the C kernel: argument shapes, memory and calls. No arithmetic.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <chrono>
#include <cstring>
#include <exception>
#include <limits>
#include <list>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "modrobust/kernel/mr_kernel.h"

extern "C" {
#include "modrobust/kernel/mr_environment.h"
}

#ifdef MR_WIDE_BATCH  // mr_batch.c, compiled once more for each (CMakeLists.txt)
extern "C" decltype(mr_inverse_dynamics_bounds_batch) mr_inverse_dynamics_bounds_batch_avx2,
    mr_inverse_dynamics_bounds_batch_avx512;
#endif

namespace nb = nanobind;
using namespace nb::literals;

using Vec = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Mat = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Stack = nb::ndarray<const double, nb::shape<-1, 4, 4>, nb::c_contig, nb::device::cpu>;
using Ints = nb::ndarray<const int32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Out = nb::ndarray<nb::numpy, double, nb::c_contig>;
using Doubles = std::vector<double>;

namespace {

PyObject *kernel_status_type = nullptr;

void check(mr_status status) {
    if (status == MR_OK) return;
    PyErr_SetObject(kernel_status_type, nb::make_tuple(static_cast<int>(status)).ptr());
    throw nb::python_error();
}

void require(bool ok, const char *what) {
    if (!ok) throw std::invalid_argument(what);
}

Out numpy(Doubles &&data, std::vector<size_t> shape) {
    auto *owned = new Doubles(std::move(data));
    nb::capsule owner(owned, [](void *p) noexcept { delete static_cast<Doubles *>(p); });
    return Out(owned->data(), shape.size(), shape.data(), owner);
}

Doubles doubles(const Vec &v) { return Doubles(v.data(), v.data() + v.size()); }
std::vector<int32_t> ints(const Ints &v) { return {v.data(), v.data() + v.size()}; }

std::vector<mr_transform> transforms(const Stack &T) {
    std::vector<mr_transform> out(T.shape(0));
    for (size_t i = 0; i < out.size(); ++i)
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c) out[i].R[3 * r + c] = T.data()[16 * i + 4 * r + c];
            out[i].p[r] = T.data()[16 * i + 4 * r + 3];
        }
    return out;
}

// mr_enter for Python; the x87 unit, which rounds long doubles, has a rounding mode of its own.
nb::tuple enter_environment() {
    const mr_environment caller = mr_enter();
    const int rounding = std::fegetround();
    if (rounding != FE_TONEAREST) std::fesetround(FE_TONEAREST);
    return nb::make_tuple(caller, rounding);
}

void leave_environment(const nb::tuple &caller) {
    const int rounding = nb::cast<int>(caller[1]);
    if (rounding != FE_TONEAREST) std::fesetround(rounding);
    mr_leave(nb::cast<mr_environment>(caller[0]));
}

class Model {
  public:
    Model(const Ints &joint_type, const Ints &parent, const Stack &before, const Stack &after,
          const Vec &gravity, const Ints &body_joint, const Stack &placement,
          const Ints &inertia_about, const Vec &gear_ratio, const Vec &coulomb_speed,
          const Ints &moves, const Ints &leader, const Vec &multiplier, const Vec &offset,
          const Ints &wraps)
        : types(ints(joint_type)), parents(ints(parent)), befores(transforms(before)),
          afters(transforms(after)), joints(ints(body_joint)), placements(transforms(placement)),
          abouts(ints(inertia_about)), ratios(doubles(gear_ratio)), speeds(doubles(coulomb_speed)),
          moved(ints(moves)), leaders(ints(leader)), multipliers(doubles(multiplier)),
          offsets(doubles(offset)), wrapping(ints(wraps)) {
        const size_t j = types.size(), b = joints.size(), mimic_joints = leaders.size();
        require(j > mimic_joints && parents.size() == j && befores.size() == j &&
                    afters.size() == j && ratios.size() == j && speeds.size() == j &&
                    placements.size() == b && abouts.size() == b && gravity.size() == 3 &&
                    moved.size() == j && multipliers.size() == mimic_joints &&
                    offsets.size() == mimic_joints,
                "Model: arrays of joints and bodies differ in length");
        const size_t free = j - mimic_joints;
        for (int32_t l : leaders)
            require(l >= 0 && l < static_cast<int32_t>(free), "Model: a leader is a free joint");
        std::vector<int32_t> once(moved);
        std::sort(once.begin(), once.end());
        for (size_t i = 0; i < j; ++i)
            require(once[i] == static_cast<int32_t>(i) &&
                        (i == 0 || i >= free || moved[i - 1] < moved[i]),
                    "Model: moves names each joint once, the free ones first and ascending");
        for (size_t i = 0; i < j; ++i) {
            require(parents[i] >= -1 && parents[i] < static_cast<int32_t>(i),
                    "Model: a joint's parent must come before it");
            require(types[i] == MR_REVOLUTE || types[i] == MR_PRISMATIC,
                    "Model: joint types are 0 (revolute) and 1 (prismatic)");
        }
        require(wrapping.size() == free, "Model: wraps has one entry a free joint");
        for (size_t i = 0; i < free; ++i)
            require(!wrapping[i] || types[static_cast<size_t>(moved[i])] == MR_REVOLUTE,
                    "Model: a prismatic joint wraps");
        for (size_t k = 0; k < mimic_joints; ++k)
            require(!wrapping[static_cast<size_t>(leaders[k])] ||
                        (types[static_cast<size_t>(moved[free + k])] == MR_REVOLUTE &&
                         multipliers[k] == std::nearbyint(multipliers[k])),
                    "Model: a joint wraps whose mimic joints do not turn by whole turns with it");
        for (int32_t joint : joints)
            require(joint >= -1 && joint < static_cast<int32_t>(j),
                    "Model: a body's joint must exist");
        for (int32_t about : abouts)
            require(about == MR_ABOUT_COM || about == MR_ABOUT_FRAME,
                    "Model: inertia is about 0 (COM) or 1 (frame)");
        c.n = static_cast<int32_t>(free);
        c.j = static_cast<int32_t>(j);
        c.b = static_cast<int32_t>(b);
        c.joint_type = types.data();
        c.parent = parents.data();
        c.before = befores.data();
        c.after = afters.data();
        c.body_joint = joints.data();
        c.placement = placements.data();
        c.inertia_about = abouts.data();
        c.gear_ratio = ratios.data();
        c.coulomb_speed = speeds.data();
        c.moves = moved.data();
        c.leader = leaders.data();
        c.multiplier = multipliers.data();
        c.offset = offsets.data();
        const bool any =
            std::any_of(wrapping.begin(), wrapping.end(), [](int32_t w) { return w; });
        c.wraps = any ? wrapping.data() : nullptr;
        std::memcpy(c.gravity, gravity.data(), sizeof c.gravity);
        precomputed.resize(mr_precomputed_size(&c));
        mr_precompute_model(&c, precomputed.data());
        c.precomputed = precomputed.data();
    }
    Model(const Model &) = delete;

    void require_joints(const Vec &v, const char *name) const {
        if (v.size() != static_cast<size_t>(c.n))
            throw std::invalid_argument(std::string(name) + ": expected " + std::to_string(c.n) +
                                        " entries, got " + std::to_string(v.size()));
    }
    void require_parameters(const Vec &v) const {
        require(v.size() == mr_parameters_size(&c), "parameters: wrong packed length");
    }
    size_t n() const { return static_cast<size_t>(c.n); }

    mr_model c{};

  private:
    std::vector<int32_t> types, parents;
    std::vector<mr_transform> befores, afters;
    std::vector<int32_t> joints;
    std::vector<mr_transform> placements;
    std::vector<int32_t> abouts;
    Doubles ratios, speeds;
    std::vector<int32_t> moved, leaders;
    Doubles multipliers, offsets, precomputed;
    std::vector<int32_t> wrapping;
};

// The known box of parameters and disturbance; borrows the arrays or owns copies of them.
class Bounds {
  public:
    Bounds(const Model &model, const Vec &nominal, const Vec &lower, const Vec &upper,
           const double *disturbance) {
        for (const Vec *v : {&nominal, &lower, &upper}) model.require_parameters(*v);
        c.nominal = mr_parameters_view(&model.c, nominal.data());
        c.lower = mr_parameters_view(&model.c, lower.data());
        c.upper = mr_parameters_view(&model.c, upper.data());
        c.disturbance_lo = disturbance;
        c.disturbance_hi = disturbance ? disturbance + model.c.n : nullptr;
        uncertain.resize(static_cast<size_t>(model.c.b));
        c.uncertain_count = mr_find_uncertain(model.c.b, &c.lower, &c.upper, uncertain.data());
        c.uncertain = uncertain.data();
        prepared.resize(mr_prepared_size(&model.c));
        mr_prepare(&model.c, &c, prepared.data());
        c.prepared = prepared.data();
    }
    mr_bounds c{};

  private:
    std::vector<int32_t> uncertain;
    Doubles prepared;
};

mr_method method_of(int method) {
    require(method == MR_HULL || method == MR_IANEA, "bound: 0 (hull) or 1 (ianea)");
    return static_cast<mr_method>(method);
}

void require_state(const Model &model, const Vec &q, const Vec &dq, const Vec &dq_a,
                   const Vec &ddq_a) {
    model.require_joints(q, "q");
    model.require_joints(dq, "dq");
    model.require_joints(dq_a, "dq_a");
    model.require_joints(ddq_a, "ddq_a");
}

Out inverse_dynamics(const Model &model, const Vec &parameters, const Vec &q, const Vec &dq,
                     const Vec &dq_a, const Vec &ddq_a, bool drives) {
    model.require_parameters(parameters);
    require_state(model, q, dq, dq_a, ddq_a);
    const mr_parameters view = mr_parameters_view(&model.c, parameters.data());
    Doubles workspace(mr_workspace_size(&model.c)), tau(model.n());
    check(mr_inverse_dynamics(&model.c, &view, q.data(), dq.data(), dq_a.data(), ddq_a.data(),
                              drives, workspace.data(), tau.data()));
    return numpy(std::move(tau), {model.n()});
}

Out inverse_dynamics_bounds(const Model &model, const Vec &nominal, const Vec &lower,
                            const Vec &upper, const Vec &q, const Vec &dq, const Vec &dq_a,
                            const Vec &ddq_a, int method, bool drives) {
    require_state(model, q, dq, dq_a, ddq_a);
    const Bounds bounds(model, nominal, lower, upper, nullptr);
    Doubles workspace(mr_workspace_size(&model.c)), out(2 * model.n());
    check(mr_inverse_dynamics_bounds(&model.c, &bounds.c, method_of(method), q.data(), dq.data(),
                                     dq_a.data(), ddq_a.data(), drives, workspace.data(),
                                     out.data(), out.data() + model.n()));
    return numpy(std::move(out), {2, model.n()});
}

using Batch = decltype(&mr_inverse_dynamics_bounds_batch);

// The batch as compiled for the widest registers that this machine has; same bits, less time.
Batch widest_batch() {
#ifdef MR_WIDE_BATCH
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl"))
        return mr_inverse_dynamics_bounds_batch_avx512;
    if (__builtin_cpu_supports("avx2")) return mr_inverse_dynamics_bounds_batch_avx2;
#endif
    return mr_inverse_dynamics_bounds_batch;
}

// A status other than OK raises KernelError(status, row) with the first row that has it.
Out inverse_dynamics_bounds_batch(const Model &model, const Vec &nominal, const Vec &lower,
                                  const Vec &upper, const Mat &q, const Mat &dq, const Mat &dq_a,
                                  const Mat &ddq_a, int method, bool drives, size_t threads) {
    const size_t n = model.n(), count = q.shape(0);
    for (const Mat *m : {&q, &dq, &dq_a, &ddq_a})
        require(m->shape(0) == count && m->shape(1) == n, "states: expected shape (k, n)");
    require(threads > 0, "threads must be positive");
    static const Batch batch = widest_batch();
    const Bounds bounds(model, nominal, lower, upper, nullptr);
    const mr_method code = method_of(method);
    // A share is a multiple of the widest register, so that only the last one is padded.
    const size_t share = (count / threads / 8 + 1) * 8;
    const size_t parts = (count + share - 1) / share, size = mr_batch_workspace_size(&model.c);
    Doubles out(2 * count * n), workspace(parts * size);
    std::vector<mr_status> status(parts, MR_OK);
    std::vector<int64_t> rows(parts, 0);
    const auto work = [&](size_t part) {
        const size_t first = part * share, at = first * n;
        status[part] =
            batch(&model.c, &bounds.c, code, static_cast<int64_t>(std::min(share, count - first)),
                  q.data() + at, dq.data() + at, dq_a.data() + at, ddq_a.data() + at, drives,
                  workspace.data() + part * size, out.data() + at, out.data() + count * n + at,
                  &rows[part]);
        rows[part] += static_cast<int64_t>(first);
    };
    {
        nb::gil_scoped_release release;
        std::vector<std::thread> others;
        size_t started = 1; // the calling thread has part 0, and those for which no other starts
        try {
            for (others.reserve(parts); started < parts; ++started)
                others.emplace_back(work, started);
        } catch (const std::exception &) { // neither thread nor memory to be had
        }
        if (parts > 0) work(0);
        for (size_t part = started; part < parts; ++part) work(part);
        for (std::thread &other : others) other.join();
    }
    for (size_t part = 0; part < parts; ++part) {
        if (status[part] == MR_OK) continue;
        PyErr_SetObject(kernel_status_type,
                        nb::make_tuple(static_cast<int>(status[part]), rows[part]).ptr());
        throw nb::python_error();
    }
    return numpy(std::move(out), {2, count, n});
}

Out inverse_dynamics_rounding(const Model &model, const Vec &parameters, const Vec &q,
                              const Vec &dq, const Vec &dq_a, const Vec &ddq_a, bool drives) {
    model.require_parameters(parameters);
    require_state(model, q, dq, dq_a, ddq_a);
    const mr_parameters view = mr_parameters_view(&model.c, parameters.data());
    Doubles workspace(mr_workspace_size(&model.c)), out(2 * model.n());
    check(mr_inverse_dynamics_rounding(&model.c, &view, q.data(), dq.data(), dq_a.data(),
                                       ddq_a.data(), drives, workspace.data(), out.data(),
                                       out.data() + model.n()));
    return numpy(std::move(out), {2, model.n()});
}

Out bounds_slack(const Model &model, const Vec &nominal, const Vec &lower, const Vec &upper,
                 const Vec &q, const Vec &dq, const Vec &dq_a, const Vec &ddq_a, bool drives) {
    require_state(model, q, dq, dq_a, ddq_a);
    const Bounds bounds(model, nominal, lower, upper, nullptr);
    Doubles workspace(mr_workspace_size(&model.c)), out(model.n());
    check(mr_bounds_slack(&model.c, &bounds.c, q.data(), dq.data(), dq_a.data(), ddq_a.data(),
                          drives, workspace.data(), out.data()));
    return numpy(std::move(out), {model.n()});
}

// The two rows of a disturbance, looked at before anything reads them.
const double *rows_of(const Mat &disturbance, const Model &model) {
    require(disturbance.shape(0) == 2 && disturbance.shape(1) == model.n(),
            "disturbance: expected shape (2, n)");
    return disturbance.data();
}

Out perturbation_bounds(const Model &model, const Vec &nominal, const Vec &lower, const Vec &upper,
                        const Mat &disturbance, const Vec &q, const Vec &dq, const Vec &dq_a,
                        const Vec &ddq_a, int method) {
    require_state(model, q, dq, dq_a, ddq_a);
    const Bounds bounds(model, nominal, lower, upper, rows_of(disturbance, model));
    Doubles workspace(mr_workspace_size(&model.c)), u0(model.n()), out(2 * model.n());
    check(mr_perturbation_bounds(&model.c, &bounds.c, method_of(method), q.data(), dq.data(),
                                 dq_a.data(), ddq_a.data(), workspace.data(), u0.data(),
                                 out.data(), out.data() + model.n()));
    return numpy(std::move(out), {2, model.n()});
}

Out mass_matrix(const Model &model, const Vec &parameters, const Vec &q, bool drives) {
    model.require_parameters(parameters);
    model.require_joints(q, "q");
    const mr_parameters view = mr_parameters_view(&model.c, parameters.data());
    Doubles workspace(mr_dynamics_workspace_size(&model.c)), M(model.n() * model.n());
    check(mr_mass_matrix(&model.c, &view, q.data(), drives, workspace.data(), M.data()));
    return numpy(std::move(M), {model.n(), model.n()});
}

Out forward_dynamics(const Model &model, const Vec &parameters, const Vec &q, const Vec &dq,
                     const Vec &tau, bool drives) {
    model.require_parameters(parameters);
    model.require_joints(q, "q");
    model.require_joints(dq, "dq");
    model.require_joints(tau, "tau");
    const mr_parameters view = mr_parameters_view(&model.c, parameters.data());
    Doubles workspace(mr_dynamics_workspace_size(&model.c)), ddq(model.n());
    check(mr_forward_dynamics(&model.c, &view, q.data(), dq.data(), tau.data(), drives,
                              workspace.data(), ddq.data()));
    return numpy(std::move(ddq), {model.n()});
}

Out forward_kinematics(const Model &model, const Vec &q) {
    model.require_joints(q, "q");
    const size_t j = static_cast<size_t>(model.c.j);
    Doubles workspace(mr_workspace_size(&model.c)), out(16 * j, 0.0);
    std::vector<mr_transform> frames(j);
    check(mr_forward_kinematics(&model.c, q.data(), workspace.data(), frames.data()));
    for (size_t i = 0; i < j; ++i) {
        double *T = out.data() + 16 * i;
        for (int r = 0; r < 3; ++r) {
            std::memcpy(T + 4 * r, frames[i].R + 3 * r, 3 * sizeof(double));
            T[4 * r + 3] = frames[i].p[r];
        }
        T[15] = 1.0;
    }
    return numpy(std::move(out), {j, 4, 4});
}

Out tracking_error(const Model &model, const Mat &q, const Mat &q_des) {
    const size_t n = model.n(), count = q.shape(0);
    for (const Mat *m : {&q, &q_des})
        require(m->shape(0) == count && m->shape(1) == n, "positions: expected shape (k, n)");
    Doubles error(count * n);
    for (size_t k = 0; k < count; ++k)
        check(mr_tracking_error(&model.c, q.data() + k * n, q_des.data() + k * n,
                                error.data() + k * n));
    return numpy(std::move(error), {count, n});
}

nb::tuple sine_cosine(double x) {
    double s, c;
    check(std::abs(x) <= MR_ANGLE_MAX ? MR_OK : MR_ANGLE_RANGE);
    mr_sincos(x, &s, &c);
    return nb::make_tuple(s, c);
}

// Of many angles at once, rows sine and cosine.
Out sines_cosines(const Vec &x) {
    const size_t count = x.size();
    Doubles rows(2 * count);
    for (size_t k = 0; k < count; ++k) {
        check(std::abs(x.data()[k]) <= MR_ANGLE_MAX ? MR_OK : MR_ANGLE_RANGE);
        mr_sincos(x.data()[k], &rows[k], &rows[count + k]);
    }
    return numpy(std::move(rows), {2, count});
}

// Settings by name, and copies of the arrays among them, which the kernel's structures point to.
class Named {
  public:
    explicit Named(nb::dict named) : given(named) {}
    double number(const char *name) const { return nb::cast<double>(given[name]); }
    int whole(const char *name) const { return nb::cast<int>(given[name]); }
    const double *array(const char *name, size_t size) {
        const Vec v = nb::cast<Vec>(given[name]);
        require(v.size() == size, (std::string(name) + ": wrong length").c_str());
        return keep(v);
    }
    // One entry a joint, or NULL where there is none at all.
    const double *joints(const char *name, const Model &model) {
        const Vec v = nb::cast<Vec>(given[name]);
        if (v.size() == 0) return nullptr;
        model.require_joints(v, name);
        return keep(v);
    }
    void seed(const char *name, uint64_t *to) const {
        const auto words = nb::cast<std::pair<uint64_t, uint64_t>>(given[name]);
        require(words.first || words.second, "seed: both words are 0");
        to[0] = words.first;
        to[1] = words.second;
    }

  private:
    const double *keep(const Vec &v) {
        kept.push_back(doubles(v));
        return kept.back().data();
    }

    nb::dict given;
    std::list<Doubles> kept; // whose data stays where it is
};

// Gains by name, one packed point for D_c and D_s, and the limits: what mr_gains points to.
class Gains {
  public:
    Gains(const Model &model, nb::dict named) : given(named) {
        const size_t points = mr_parameters_size(&model.c);
        const int law = given.whole("law");
        require(law >= MR_LAW_NORM && law <= MR_LAW_SAMPLED,
                "law: 0 (norm), 1 (componentwise) or 2 (sampled)");
        c.K_r = given.array("K_r", model.n());
        c.kappa_P = given.number("kappa_P");
        c.kappa_I = given.number("kappa_I");
        c.phi_P = given.number("phi_P");
        c.phi_I = given.number("phi_I");
        c.kappa_max = given.number("kappa_max");
        c.phi_max = given.number("phi_max");
        c.leak = given.number("leak");
        c.epsilon = given.number("epsilon");
        c.law = static_cast<mr_law>(law);
        c.method = method_of(given.whole("bound"));
        c.hold_aware = given.whole("hold_aware");
        c.period = given.number("period");
        c.delay = given.number("delay");
        c.G = given.number("G");
        c.Lambda = given.number("Lambda");
        c.L_i = given.number("L_i");
        c.blend = given.number("blend");
        c.integral = given.whole("integral");
        c.predictor = given.whole("predictor");
        c.vector_saturation = given.whole("vector_saturation");
        c.effort_limit = given.array("effort_limit", model.n());
        c.centre = mr_parameters_view(&model.c, given.array("centre", points));
        c.light = mr_parameters_view(&model.c, given.array("light", points));
    }
    Gains(const Gains &) = delete;
    mr_gains c{};

  private:
    Named given;
};

// The state of a controller and the memory that it points to.
class ControllerState {
  public:
    explicit ControllerState(const Model &model) : memory(mr_controller_memory_size(&model.c)) {
        reset();
    }
    ControllerState(const ControllerState &) = delete;
    void reset() {
        std::fill(memory.begin(), memory.end(), 0.0);
        c = mr_controller_state{};
        c.memory = memory.data();
    }
    Doubles memory;
    mr_controller_state c{};
};

class Controller {
  public:
    Controller(nb::object model_object, const Vec &nominal, const Vec &lower, const Vec &upper,
               const Mat &disturbance, nb::dict given)
        : owner(model_object), model(nb::cast<Model &>(model_object)),
          arrays{nominal, lower, upper}, disturbances(disturbance),
          bounds(model, nominal, lower, upper, rows_of(disturbance, model)),
          gain_values(model, given), gains(gain_values.c), state(model) {
        workspace.resize(mr_command_workspace_size(&model.c));
    }

    Out command(double t, const Vec &q, const Vec &dq, const Vec &q_des, const Vec &dq_des,
                const Vec &ddq_des) {
        require_state(model, q, dq, q_des, dq_des);
        model.require_joints(ddq_des, "ddq_des");
        Doubles rows(6 * model.n());
        mr_command_out out = outputs(rows.data());
        check(mr_command(&model.c, &bounds.c, &gains, t, q.data(), dq.data(), q_des.data(),
                         dq_des.data(), ddq_des.data(), workspace.data(), &state.c, &out));
        rho_norm = out.rho_norm;
        kappa = out.kappa;
        phi = out.phi;
        alpha = out.alpha;
        return numpy(std::move(rows), {6, model.n()});
    }

    // The command where the integral of f has this value; the controller's own state stays as it is.
    nb::tuple torque(double integral, const Vec &q, const Vec &dq, const Vec &q_des,
                     const Vec &dq_des, const Vec &ddq_des) {
        require_state(model, q, dq, q_des, dq_des);
        model.require_joints(ddq_des, "ddq_des");
        Doubles rows(6 * model.n());
        mr_command_out out = outputs(rows.data());
        ControllerState at(model);
        at.c.integral = integral;
        check(mr_command(&model.c, &bounds.c, &gains, 0.0, q.data(), dq.data(), q_des.data(),
                         dq_des.data(), ddq_des.data(), workspace.data(), &at.c, &out));
        return nb::make_tuple(numpy(std::move(rows), {6, model.n()}), out.rho_norm,
                              at.c.previous_f);
    }

    // Seconds of each command on recorded signals; the integrators start at rest.
    Out time_commands(const Vec &t, const Mat &q, const Mat &dq, const Mat &q_des,
                      const Mat &dq_des, const Mat &ddq_des) {
        const size_t count = t.size(), n = model.n();
        for (const Mat *m : {&q, &dq, &q_des, &dq_des, &ddq_des})
            require(m->shape(0) == count && m->shape(1) == n, "signals: expected shape (k, n)");
        // Memory of its own: another thread may command while this one runs without the GIL.
        Doubles seconds(count), rows(6 * n), working(mr_command_workspace_size(&model.c));
        mr_command_out out = outputs(rows.data());
        ControllerState fresh(model);
        mr_status status = MR_OK;
        {
            nb::gil_scoped_release release;
            for (size_t k = 0; k < count && status == MR_OK; ++k) {
                const auto start = std::chrono::steady_clock::now();
                status = mr_command(&model.c, &bounds.c, &gains, t.data()[k], q.data() + k * n,
                                    dq.data() + k * n, q_des.data() + k * n, dq_des.data() + k * n,
                                    ddq_des.data() + k * n, working.data(), &fresh.c, &out);
                const std::chrono::duration<double> elapsed =
                    std::chrono::steady_clock::now() - start;
                seconds[k] = elapsed.count();
            }
        }
        check(status);
        return numpy(std::move(seconds), {count});
    }

    void reset() { state.reset(); }

    // What a copy takes over: the integrators, and what the last command left.
    nb::tuple memory() const {
        return nb::make_tuple(state.c.integral, state.c.previous_f, state.c.previous_time,
                              state.c.started, state.c.start_time,
                              numpy(Doubles(state.memory), {state.memory.size()}), rho_norm, kappa,
                              phi, alpha);
    }

    void recall(double integral, double previous_f, double previous_time, int started,
                double start_time, const Vec &remembered, double last_rho_norm, double last_kappa,
                double last_phi, double last_alpha) {
        require(remembered.size() == state.memory.size(), "memory: wrong length");
        std::copy(remembered.data(), remembered.data() + remembered.size(), state.memory.begin());
        state.c.integral = integral;
        state.c.previous_f = previous_f;
        state.c.previous_time = previous_time;
        state.c.started = started;
        state.c.start_time = start_time;
        rho_norm = last_rho_norm;
        kappa = last_kappa;
        phi = last_phi;
        alpha = last_alpha;
    }

    mr_command_out outputs(double *rows) const {
        const size_t n = model.n();
        return {rows,         rows + n, rows + 2 * n, rows + 3 * n, rows + 4 * n,
                rows + 5 * n, 0.0,      0.0,          0.0,          1.0};
    }

    nb::object owner;
    const Model &model;
    std::vector<Vec> arrays;
    Mat disturbances;
    Bounds bounds;
    Gains gain_values;
    mr_gains &gains;
    ControllerState state;
    Doubles workspace;
    double rho_norm = 0.0, kappa = 0.0, phi = 0.0, alpha = 1.0;
};

// The closed loop; its controller state is its own and starts at rest.
class Loop {
  public:
    // settings: numbers by name, and arrays of n or none at all for noise and steps.
    Loop(nb::object controller_object, const Vec &true_parameters, const Vec &true_disturbance,
         const Vec &q0, const Vec &dq0, nb::dict named, nb::object engine)
        : owner(controller_object), controller(nb::cast<Controller &>(controller_object)),
          model(controller.model), parameters(doubles(true_parameters)),
          disturbance(doubles(true_disturbance)), q(doubles(q0)), dq(doubles(dq0)),
          tau_previous(model.n()), tau_max(model.n()), total_variation(model.n()),
          ticks_at_limit(model.n()), previous_q(model.n()), rate(model.n()), settings(named),
          plant(engine), state(model) {
        model.require_parameters(true_parameters);
        model.require_joints(true_disturbance, "true_disturbance");
        model.require_joints(q0, "q0");
        model.require_joints(dq0, "dq0");
        c.dt = settings.number("dt");
        c.substeps = settings.whole("substeps");
        c.implicit = settings.whole("implicit");
        c.delay = settings.number("delay");
        c.saturation = settings.whole("saturation");
        require(c.dt > 0.0 && c.dt < std::numeric_limits<double>::infinity() && c.substeps > 0,
                "dt and substeps must be positive");
        require(c.delay >= 0.0 && c.delay <= 1.0, "delay lies in [0, 1]");
        c.sensor.noise_q = settings.joints("noise_position", model);
        c.sensor.noise_dq = settings.joints("noise_velocity", model);
        c.sensor.step_q = settings.joints("quantisation_position", model);
        c.sensor.step_dq = settings.joints("quantisation_velocity", model);
        c.sensor.worst = settings.whole("noise_worst");
        c.sensor.filter = settings.number("filter");
        settings.seed("noise_seed", c.sensor.random);
        c.sensor.previous_q = previous_q.data();
        c.sensor.rate = rate.data();
        const int kind = settings.whole("disturbance");
        require(kind >= MR_CONSTANT && kind <= MR_WORST, "disturbance: 0 to 3");
        c.disturbance.kind = static_cast<mr_disturbance_kind>(kind);
        c.disturbance.constant = disturbance.data();
        c.disturbance.frequency = settings.number("frequency");
        settings.seed("disturbance_seed", c.disturbance.random);
        c.last_outside = -1.0;
        c.q = q.data();
        c.dq = dq.data();
        c.tau_previous = tau_previous.data();
        c.tau_max = tau_max.data();
        c.total_variation = total_variation.data();
        c.ticks_at_limit = ticks_at_limit.data();
        if (!plant.is_none()) c.plant = &Loop::move;
        workspace.resize(mr_loop_workspace_size(&model.c));
    }
    Loop(const Loop &) = delete;

    nb::dict advance(const Mat &q_des, const Mat &dq_des, const Mat &ddq_des, int log_every) {
        const size_t count = q_des.shape(0), n = model.n();
        for (const Mat *m : {&q_des, &dq_des, &ddq_des})
            require(m->shape(0) == count && m->shape(1) == n, "reference: expected shape (k, n)");
        require(log_every > 0, "log_every must be positive");
        const size_t rows = count / static_cast<size_t>(log_every) + 1;
        static const char *const names[] = {
            "q", "dq",     "q_des",  "dq_des", "ddq_des",    "tau",         "nominal",
            "w", "phi_lo", "phi_hi", "rho",    "width_hull", "width_ianea", "total_variation"};
        constexpr size_t columns = sizeof names / sizeof *names;
        std::vector<Doubles> data(columns, Doubles(rows * n));
        Doubles t(rows);
        mr_loop_log log = {t.data(),        data[0].data(),  data[1].data(), data[2].data(),
                           data[3].data(),  data[4].data(),  data[5].data(), data[6].data(),
                           data[7].data(),  data[8].data(),  data[9].data(), data[10].data(),
                           data[11].data(), data[12].data(), data[13].data()};
        const mr_parameters view = mr_parameters_view(&model.c, parameters.data());
        int32_t logged = 0;
        c.context = this;
        const Kept kept_before = keep();
        {
            nb::gil_scoped_release release;
            status = mr_loop_advance(&model.c, &controller.bounds.c, &controller.gains, &view,
                                     static_cast<int32_t>(count), q_des.data(), dq_des.data(),
                                     ddq_des.data(), log_every, workspace.data(), &state.c, &c,
                                     &log, &logged);
        }
        if (failure) {
            const std::exception_ptr raised = failure;
            failure = nullptr;
            go_back(kept_before);
            std::rethrow_exception(raised);
        }
        const size_t kept = static_cast<size_t>(logged);
        nb::dict out;
        t.resize(kept);
        out["t"] = numpy(std::move(t), {kept});
        for (size_t k = 0; k < columns; ++k) {
            data[k].resize(kept * n);
            out[names[k]] = numpy(std::move(data[k]), {kept, n});
        }
        return out;
    }

    // What an advance may change; nothing where the robot is our own, which raises nothing.
    struct Kept {
        mr_loop loop;
        mr_status status;
        mr_controller_state controller;
        std::vector<Doubles> arrays;
    };

    std::vector<Doubles *> changing() {
        return {&q,          &dq,   &tau_previous, &tau_max, &total_variation, &ticks_at_limit,
                &previous_q, &rate, &state.memory};
    }

    Kept keep() {
        Kept kept{c, status, state.c, {}};
        if (!plant.is_none())
            for (const Doubles *array : changing()) kept.arrays.push_back(*array);
        return kept;
    }

    void go_back(const Kept &kept) {
        c = kept.loop;
        status = kept.status;
        state.c = kept.controller;
        const auto arrays = changing();
        for (size_t k = 0; k < arrays.size(); ++k) // in place: pointers to them stay
            std::copy(kept.arrays[k].begin(), kept.arrays[k].end(), arrays[k]->begin());
    }

    // One step of a robot in Python: step(q, dq, drive, h) gives q and dq after it. KernelError is
    // its status; anything else that it raises is raised by `advance`, with the loop as it was.
    static mr_status move(void *context, double h, const double *drive, double *q, double *dq) {
        Loop &loop = *static_cast<Loop *>(context);
        const size_t n = loop.model.n();
        nb::gil_scoped_acquire hold;
        try {
            const auto array = [&](const double *from) {
                return numpy(Doubles(from, from + n), {n});
            };
            const auto after = nb::cast<std::pair<Vec, Vec>>(
                loop.plant.attr("step")(array(q), array(dq), array(drive), h));
            loop.model.require_joints(after.first, "q");
            loop.model.require_joints(after.second, "dq");
            std::copy(after.first.data(), after.first.data() + n, q);
            std::copy(after.second.data(), after.second.data() + n, dq);
        } catch (const nb::python_error &problem) {
            if (!problem.matches(kernel_status_type)) loop.failure = std::current_exception();
            return MR_DIVERGED;
        } catch (...) {
            loop.failure = std::current_exception();
            return MR_DIVERGED;
        }
        return MR_OK;
    }

    Out copy(const Doubles &v) const { return numpy(Doubles(v), {v.size()}); }

    nb::object owner;
    Controller &controller;
    const Model &model;
    Doubles parameters, disturbance, q, dq, tau_previous, tau_max, total_variation, ticks_at_limit;
    Doubles previous_q, rate, workspace;
    Named settings;
    nb::object plant;
    ControllerState state;
    mr_loop c{};
    mr_status status = MR_OK;
    std::exception_ptr failure;
};

} // namespace

NB_MODULE(_kernel, m) {
    nb::set_leak_warnings(false); // objects that a traceback holds at exit are no news to users
    m.doc() = "The modrobust kernel; see modrobust.dynamics for the checked functions.";
    kernel_status_type =
        PyErr_NewException("modrobust._kernel.KernelError", PyExc_ArithmeticError, nullptr);
    if (mr_self_test() != MR_OK)
        throw nb::import_error(
            "modrobust: this build or machine does not round as the guarantee needs it; rebuild "
            "with the flags of src/modrobust/kernel/flags.txt and without fast-math");
    m.attr("KernelError") = nb::handle(kernel_status_type);
    m.attr("HULL") = static_cast<int>(MR_HULL);
    m.attr("IANEA") = static_cast<int>(MR_IANEA);
    m.attr("STATUS_OK") = static_cast<int>(MR_OK);
    m.attr("STATUS_NOT_FINITE") = static_cast<int>(MR_NOT_FINITE);
    m.attr("STATUS_ANGLE_RANGE") = static_cast<int>(MR_ANGLE_RANGE);
    m.attr("STATUS_SINGULAR") = static_cast<int>(MR_SINGULAR);
    m.attr("STATUS_TIME") = static_cast<int>(MR_TIME);
    m.attr("STATUS_DIVERGED") = static_cast<int>(MR_DIVERGED);
    m.attr("STATUS_PLATFORM") = static_cast<int>(MR_PLATFORM);
    m.attr("ANGLE_MAX") = MR_ANGLE_MAX;

    nb::class_<Model>(m, "Model")
        .def(nb::init<const Ints &, const Ints &, const Stack &, const Stack &, const Vec &,
                      const Ints &, const Stack &, const Ints &, const Vec &, const Vec &,
                      const Ints &, const Ints &, const Vec &, const Vec &, const Ints &>(),
             "joint_type"_a, "parent"_a, "before"_a, "after"_a, "gravity"_a, "body_joint"_a,
             "placement"_a, "inertia_about"_a, "gear_ratio"_a, "coulomb_speed"_a, "moves"_a,
             "leader"_a, "multiplier"_a, "offset"_a, "wraps"_a)
        .def_prop_ro("n", [](const Model &model) { return model.c.n; })
        .def_prop_ro("b", [](const Model &model) { return model.c.b; });

    m.def("enter_environment", &enter_environment);
    m.def("leave_environment", &leave_environment, "caller"_a);
    m.def("sincos", &sine_cosine, "x"_a);
    m.def("tracking_error", &tracking_error, "model"_a, "q"_a, "q_des"_a);
    m.def("sines_cosines", &sines_cosines, "x"_a);
    m.def("inverse_dynamics", &inverse_dynamics, "model"_a, "parameters"_a, "q"_a, "dq"_a,
          "dq_a"_a, "ddq_a"_a, "drives"_a);
    m.def("inverse_dynamics_bounds", &inverse_dynamics_bounds, "model"_a, "nominal"_a, "lower"_a,
          "upper"_a, "q"_a, "dq"_a, "dq_a"_a, "ddq_a"_a, "bound"_a, "drives"_a);
    m.def("inverse_dynamics_bounds_batch", &inverse_dynamics_bounds_batch, "model"_a, "nominal"_a,
          "lower"_a, "upper"_a, "q"_a, "dq"_a, "dq_a"_a, "ddq_a"_a, "bound"_a, "drives"_a,
          "threads"_a);
    m.def("inverse_dynamics_rounding", &inverse_dynamics_rounding, "model"_a, "parameters"_a,
          "q"_a, "dq"_a, "dq_a"_a, "ddq_a"_a, "drives"_a);
    m.def("bounds_slack", &bounds_slack, "model"_a, "nominal"_a, "lower"_a, "upper"_a, "q"_a,
          "dq"_a, "dq_a"_a, "ddq_a"_a, "drives"_a);
    m.def("perturbation_bounds", &perturbation_bounds, "model"_a, "nominal"_a, "lower"_a,
          "upper"_a, "disturbance"_a, "q"_a, "dq"_a, "dq_a"_a, "ddq_a"_a, "bound"_a);
    m.def("mass_matrix", &mass_matrix, "model"_a, "parameters"_a, "q"_a, "drives"_a);
    m.def("forward_dynamics", &forward_dynamics, "model"_a, "parameters"_a, "q"_a, "dq"_a, "tau"_a,
          "drives"_a);
    m.def("forward_kinematics", &forward_kinematics, "model"_a, "q"_a);

    nb::class_<Controller>(m, "Controller")
        .def(nb::init<nb::object, const Vec &, const Vec &, const Vec &, const Mat &, nb::dict>(),
             "model"_a, "nominal"_a, "lower"_a, "upper"_a, "disturbance"_a, "gains"_a)
        .def("command", &Controller::command, "t"_a, "q"_a, "dq"_a, "q_des"_a, "dq_des"_a,
             "ddq_des"_a)
        .def("torque", &Controller::torque, "integral"_a, "q"_a, "dq"_a, "q_des"_a, "dq_des"_a,
             "ddq_des"_a)
        .def("time_commands", &Controller::time_commands, "t"_a, "q"_a, "dq"_a, "q_des"_a,
             "dq_des"_a, "ddq_des"_a)
        .def("reset", &Controller::reset)
        .def("memory", &Controller::memory)
        .def("recall", &Controller::recall, "integral"_a, "previous_f"_a, "previous_time"_a,
             "started"_a, "start_time"_a, "memory"_a, "rho_norm"_a, "kappa"_a, "phi"_a, "alpha"_a)
        .def_ro("rho_norm", &Controller::rho_norm)
        .def_prop_ro("integral_rate", [](const Controller &c) { return c.state.c.previous_f; })
        .def_ro("kappa", &Controller::kappa)
        .def_ro("phi", &Controller::phi)
        .def_ro("alpha", &Controller::alpha);

    nb::class_<Loop>(m, "Loop")
        .def(nb::init<nb::object, const Vec &, const Vec &, const Vec &, const Vec &, nb::dict,
                      nb::object>(),
             "controller"_a, "true_parameters"_a, "true_disturbance"_a, "q0"_a, "dq0"_a,
             "settings"_a, "plant"_a.none())
        .def("advance", &Loop::advance, "q_des"_a, "dq_des"_a, "ddq_des"_a, "log_every"_a)
        .def_prop_ro("status", [](const Loop &l) { return static_cast<int>(l.status); })
        .def_prop_ro("time", [](const Loop &l) { return double(l.c.ticks) * l.c.dt; })
        .def_prop_ro("ticks", [](const Loop &l) { return l.c.ticks; })
        .def_prop_ro("violations", [](const Loop &l) { return l.c.violations; })
        .def_prop_ro("violation_max", [](const Loop &l) { return l.c.violation_max; })
        .def_prop_ro("error_last", [](const Loop &l) { return l.c.error_last; })
        .def_prop_ro("last_outside", [](const Loop &l) { return l.c.last_outside; })
        .def_prop_ro("error_max_after", [](const Loop &l) { return l.c.error_max_after; })
        .def_prop_ro("rho_sum", [](const Loop &l) { return l.c.rho_sum; })
        .def_prop_ro("rho_max", [](const Loop &l) { return l.c.rho_max; })
        .def_prop_ro("limited", [](const Loop &l) { return l.c.limited; })
        .def_prop_ro(
            "q", [](const Loop &l) { return l.copy(l.q); }, nb::rv_policy::move)
        .def_prop_ro(
            "dq", [](const Loop &l) { return l.copy(l.dq); }, nb::rv_policy::move)
        .def_prop_ro(
            "tau_max", [](const Loop &l) { return l.copy(l.tau_max); }, nb::rv_policy::move)
        .def_prop_ro(
            "ticks_at_limit", [](const Loop &l) { return l.copy(l.ticks_at_limit); },
            nb::rv_policy::move);
}
