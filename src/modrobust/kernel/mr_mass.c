/* Link frames, mass matrix by composite bodies, forward dynamics of the plant, (22), (23). */
#include "mr_internal.h"

/* One composite body about its link frame's origin: m, h = m c, I. */
typedef struct {
    double m, h[3], I[6];
} mr_composite;

#define COMPOSITE_DOUBLES (sizeof(mr_composite) / sizeof(double))

/* out += R S R' for symmetric S */
static void add_rotated(const double R[9], const double S[6], double out[6]) {
    const double full[9] = {S[0], S[1], S[2], S[1], S[3], S[4], S[2], S[4], S[5]};
    double RS[9];
    mr_multiply(R, full, RS);
    out[0] += mr_dot(RS, R);
    out[1] += mr_dot(RS, R + 3);
    out[2] += mr_dot(RS, R + 6);
    out[3] += mr_dot(RS + 3, R + 3);
    out[4] += mr_dot(RS + 3, R + 6);
    out[5] += mr_dot(RS + 6, R + 6);
}

/* out += body, whose frame stands at (R, p) in the frame of out. */
static void add_composite(const mr_composite *body, const double R[9], const double p[3],
                          mr_composite *out) {
    double h[3];
    mr_rotate(R, body->h, h);
    add_rotated(R, body->I, out->I);
    const double m = body->m, d = 2.0 * mr_dot(p, h) + m * mr_dot(p, p);
    out->I[0] += d - 2.0 * p[0] * h[0] - m * p[0] * p[0];
    out->I[1] -= p[0] * h[1] + h[0] * p[1] + m * p[0] * p[1];
    out->I[2] -= p[0] * h[2] + h[0] * p[2] + m * p[0] * p[2];
    out->I[3] += d - 2.0 * p[1] * h[1] - m * p[1] * p[1];
    out->I[4] -= p[1] * h[2] + h[1] * p[2] + m * p[1] * p[2];
    out->I[5] += d - 2.0 * p[2] * h[2] - m * p[2] * p[2];
    out->m += m;
    mr_add(h, out->h);
    mr_add_scaled(m, p, out->h);
}

/* Force and moment about the link frame's origin under unit acceleration of joint i. */
static void unit_wrench(const mr_model *model, int32_t i, const mr_link *link,
                        const mr_composite *body, mr_wrench *out) {
    const double *z = model->after[i].R + 6;
    if (model->joint_type[i] == MR_REVOLUTE) {
        double v[3];
        mr_cross(z, link->p, v);
        mr_cross(z, body->h, out->f);
        mr_add_scaled(body->m, v, out->f);
        mr_symmetric(body->I, z, out->n);
        mr_add_cross(body->h, v, out->n);
    } else {
        for (int k = 0; k < 3; ++k) out->f[k] = body->m * z[k];
        mr_cross(body->h, z, out->n);
    }
}

/* G' M G for the map G of (15), from (j, j) to (n, n) in place. */
static void fold_mimic_inertia(const mr_model *model, double *M) {
    const int32_t n = model->n, j = model->j, *moves = model->moves;
    if (j == n) return;
    for (int32_t k = 0; k < j - n; ++k)
        for (int32_t c = 0; c < j; ++c)
            M[moves[model->leader[k]] * j + c] += model->multiplier[k] * M[moves[n + k] * j + c];
    for (int32_t k = 0; k < j - n; ++k)
        for (int32_t r = 0; r < n; ++r)
            M[moves[r] * j + moves[model->leader[k]]] +=
                model->multiplier[k] * M[moves[r] * j + moves[n + k]];
    for (int32_t r = 0; r < n; ++r)
        for (int32_t c = 0; c < n; ++c) M[r * n + c] = M[moves[r] * j + moves[c]];
}

void mr_composite_mass(const mr_model *model, const mr_parameters *parameters,
                       const mr_link *links, int drives, double *composite, double *M) {
    const int32_t n = model->j;
    mr_composite *bodies = (mr_composite *)composite;
    for (size_t k = 0; k < (size_t)n * COMPOSITE_DOUBLES; ++k) composite[k] = 0.0;
    for (int32_t b = 0; b < model->b; ++b) {
        if (model->body_joint[b] < 0) continue;
        static const double axes[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
        const double m = parameters->mass[b], *c = parameters->com + 3 * b;
        const mr_composite given = {
            m,
            {0.0, 0.0, 0.0},
            {parameters->inertia[6 * b], parameters->inertia[6 * b + 1],
             parameters->inertia[6 * b + 2], parameters->inertia[6 * b + 3],
             parameters->inertia[6 * b + 4], parameters->inertia[6 * b + 5]}};
        mr_composite body = {0.0, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0}};
        if (model->inertia_about[b] == MR_ABOUT_FRAME) {
            body = given;
            mr_add_scaled(m, c, body.h);
        } else {
            add_composite(&given, axes, c, &body);
        }
        add_composite(&body, model->placement[b].R, model->placement[b].p,
                      &bodies[model->body_joint[b]]);
    }
    for (int32_t i = 0; i < n * n; ++i) M[i] = 0.0;

    for (int32_t i = n - 1; i >= 0; --i) {
        mr_wrench wrench;
        unit_wrench(model, i, &links[i], &bodies[i], &wrench);
        for (int32_t j = i;;) {
            const mr_link *link = &links[j];
            const int32_t parent = model->parent[j];
            double f[3], n_parent[3];
            mr_add_cross(link->p, wrench.f, wrench.n); /* now about the joint frame's origin */
            const double *along = model->joint_type[j] == MR_REVOLUTE ? wrench.n : wrench.f;
            M[i * n + j] = M[j * n + i] = mr_dot(along, model->after[j].R + 6);
            if (parent < 0) break;
            mr_rotate(link->R, wrench.f, f);
            mr_rotate(link->R, wrench.n, n_parent);
            mr_add_cross(model->before[j].p, f, n_parent);
            mr_copy(f, wrench.f);
            mr_copy(n_parent, wrench.n);
            j = parent;
        }
        if (drives)
            M[i * n + i] +=
                model->gear_ratio[i] * model->gear_ratio[i] * parameters->rotor_inertia[i];
        if (model->parent[i] >= 0) {
            double p[3];
            mr_rotate(links[i].R, links[i].p, p);
            mr_add(model->before[i].p, p);
            add_composite(&bodies[i], links[i].R, p, &bodies[model->parent[i]]);
        }
    }
    fold_mimic_inertia(model, M);
}

mr_status mr_cholesky_solve(int32_t n, double *M, double *x) {
    for (int32_t i = 0; i < n; ++i) {
        for (int32_t j = 0; j <= i; ++j) {
            double sum = M[i * n + j];
            for (int32_t k = 0; k < j; ++k) sum -= M[i * n + k] * M[j * n + k];
            if (i == j) {
                if (!(sum > 0.0)) return MR_SINGULAR;
                M[i * n + i] = sqrt(sum);
            } else {
                M[i * n + j] = sum / M[j * n + j];
            }
        }
    }
    for (int32_t i = 0; i < n; ++i) {
        for (int32_t k = 0; k < i; ++k) x[i] -= M[i * n + k] * x[k];
        x[i] /= M[i * n + i];
    }
    for (int32_t i = n - 1; i >= 0; --i) {
        for (int32_t k = i + 1; k < n; ++k) x[i] -= M[k * n + i] * x[k];
        x[i] /= M[i * n + i];
    }
    return MR_OK;
}

mr_status mr_do_forward_kinematics(const mr_model *model, const double *q, double *workspace,
                                   mr_transform *frames) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    const mr_state given = {q, q, q, q, NULL, NULL};
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, &given, &state);
    if (status) return status;
    mr_all_sines(model, state.q, ws.sines);
    for (int32_t i = 0; i < model->j; ++i) {
        mr_link *link = &ws.links[i];
        double position[3];
        mr_joint_geometry(model, i, state.q, ws.sines, link);
        mr_rotate(link->R, link->p, position);
        mr_add(model->before[i].p, position);
        mr_pose *pose = &ws.poses[i];
        if (model->parent[i] < 0) {
            for (int k = 0; k < 9; ++k) pose->R[k] = link->R[k];
            mr_copy(position, pose->origin);
        } else {
            const mr_pose *parent = &ws.poses[model->parent[i]];
            mr_multiply(parent->R, link->R, pose->R);
            mr_rotate(parent->R, position, pose->origin);
            mr_add(parent->origin, pose->origin);
        }
        if (!mr_all_finite(9, pose->R) || !mr_all_finite(3, pose->origin)) return MR_NOT_FINITE;
    }
    for (int32_t i = 0; i < model->j; ++i) {
        for (int k = 0; k < 9; ++k) frames[i].R[k] = ws.poses[i].R[k];
        mr_copy(ws.poses[i].origin, frames[i].p);
    }
    return MR_OK;
}

size_t mr_dynamics_workspace_size(const mr_model *model) {
    const size_t j = (size_t)model->j;
    return mr_workspace_size(model) + j * (COMPOSITE_DOUBLES + j);
}

void mr_mass_here(const mr_model *model, const mr_parameters *parameters, double *workspace,
                  double *M) {
    const mr_workspace ws = mr_workspace_view(model, workspace);
    mr_composite_mass(model, parameters, ws.links, 1, workspace + mr_workspace_size(model), M);
}

mr_status mr_do_mass_matrix(const mr_model *model, const mr_parameters *parameters,
                            const double *q, int drives, double *workspace, double *M) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    double *composite = workspace + mr_workspace_size(model);
    double *result = composite + (size_t)model->j * COMPOSITE_DOUBLES;
    const mr_state given = {q, q, q, q, NULL, NULL};
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, &given, &state);
    if (status) return status;
    mr_all_sines(model, state.q, ws.sines);
    for (int32_t i = 0; i < model->j; ++i)
        mr_joint_geometry(model, i, state.q, ws.sines, &ws.links[i]);
    mr_composite_mass(model, parameters, ws.links, drives, composite, result);
    if (!mr_all_finite(model->n * model->n, result)) return MR_NOT_FINITE;
    for (int32_t i = 0; i < model->n * model->n; ++i) M[i] = result[i];
    return MR_OK;
}

mr_status mr_do_forward_dynamics(const mr_model *model, const mr_parameters *parameters,
                                 const double *q, const double *dq, const double *tau, int drives,
                                 double *workspace, double *ddq) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    double *composite = workspace + mr_workspace_size(model);
    double *M = composite + (size_t)model->j * COMPOSITE_DOUBLES;
    double *zero = ws.ddq_a, *x = ws.mid;
    mr_state state;
    if (!mr_all_finite(model->n, tau)) return MR_NOT_FINITE;
    for (int32_t i = 0; i < model->n; ++i) zero[i] = 0.0;
    const mr_state given = {q, dq, dq, zero, NULL, NULL};
    mr_status status = mr_full_state(model, &ws, &given, &state);
    if (status) return status;
    mr_point_of(model, parameters, ws.point);
    mr_newton_euler(model, ws.point, &state, &ws, x);
    if (drives) mr_add_drives(model, parameters, &state, x);
    mr_fold_mimic_torque(model, x);
    for (int32_t i = 0; i < model->n; ++i) x[i] = tau[i] - x[i];
    mr_composite_mass(model, parameters, ws.links, drives, composite, M);
    status = mr_cholesky_solve(model->n, M, x);
    if (status) return status;
    if (!mr_all_finite(model->n, x)) return MR_NOT_FINITE;
    for (int32_t i = 0; i < model->n; ++i) ddq[i] = x[i];
    return MR_OK;
}
