/* The exact range of the torque over the box of parameters, body by body: (17) to (19).
 *
 * Everything is a difference from the nominal point, so that exact parameters cost nothing and
 * leave no rounding behind. Rounding is to nearest and not yet enclosed: docs/guarantees.md. */
#include "mr_internal.h"

typedef struct {
    double g[3];    /* gradient at the nominal COM */
    double Q[6];    /* xx xy xz yy yz zz */
    double lo[3], hi[3]; /* box of the COM's difference from nominal, contains 0 */
} mr_quadratic;

static const int ROW[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

static double quadratic_value(const mr_quadratic *f, const double x[3]) {
    double Qx[3];
    mr_symmetric(f->Q, x, Qx);
    return mr_dot(f->g, x) + mr_dot(x, Qx);
}

/* Shrinks the box to the end where the maximum lies, in every direction in which the function is
 * monotonic over the whole box; returns how many directions remain open. */
static int fix_monotonic(mr_quadratic *f) {
    int open, changed;
    do {
        open = 0;
        changed = 0;
        for (int k = 0; k < 3; ++k) {
            if (f->lo[k] == f->hi[k]) continue;
            double slope_lo = f->g[k], slope_hi = f->g[k];
            for (int j = 0; j < 3; ++j) {
                const double at_lo = 2.0 * f->Q[ROW[k][j]] * f->lo[j];
                const double at_hi = 2.0 * f->Q[ROW[k][j]] * f->hi[j];
                slope_lo += at_lo < at_hi ? at_lo : at_hi;
                slope_hi += at_lo < at_hi ? at_hi : at_lo;
            }
            if (slope_lo >= 0.0) {
                f->lo[k] = f->hi[k];
                changed = 1;
            } else if (slope_hi <= 0.0) {
                f->hi[k] = f->lo[k];
                changed = 1;
            } else {
                ++open;
            }
        }
    } while (changed && open);
    return open;
}

/* The stationary point in the directions of `inside` with the others held at x; 0 unless it is a
 * strict maximum there, because only then the face's maximum is not on the face's border. */
static int stationary(const mr_quadratic *f, const int *inside, int count, double x[3]) {
    double A[3][3], rhs[3];
    for (int r = 0; r < count; ++r) {
        rhs[r] = 0.5 * f->g[inside[r]];
        for (int k = 0; k < 3; ++k) {
            int free = 0;
            for (int c = 0; c < count; ++c) {
                if (inside[c] != k) continue;
                A[r][c] = -f->Q[ROW[inside[r]][k]];
                free = 1;
            }
            if (!free) rhs[r] += f->Q[ROW[inside[r]][k]] * x[k];
        }
    }
    for (int c = 0; c < count; ++c) { /* elimination: every pivot positive = positive definite */
        if (!(A[c][c] > 0.0)) return 0;
        for (int r = c + 1; r < count; ++r) {
            const double ratio = A[r][c] / A[c][c];
            for (int k = c; k < count; ++k) A[r][k] -= ratio * A[c][k];
            rhs[r] -= ratio * rhs[c];
        }
    }
    for (int c = count - 1; c >= 0; --c) {
        for (int k = c + 1; k < count; ++k) rhs[c] -= A[c][k] * rhs[k];
        rhs[c] /= A[c][c];
        if (!(rhs[c] >= f->lo[inside[c]] && rhs[c] <= f->hi[inside[c]])) return 0;
        x[inside[c]] = rhs[c];
    }
    return 1;
}

/* Largest value of g . x + x' Q x over the box, (19). At most 27 faces. */
static double quadratic_max(const mr_quadratic *function) {
    mr_quadratic f = *function;
    if (fix_monotonic(&f) == 0) return quadratic_value(&f, f.lo);
    double best = quadratic_value(&f, f.lo);
    int choices[3], choice[3];
    for (int k = 0; k < 3; ++k) /* a direction with upward curvature has its maximum at an end */
        choices[k] = f.lo[k] == f.hi[k] ? 1 : f.Q[ROW[k][k]] >= 0.0 ? 2 : 3;
    for (choice[0] = 0; choice[0] < choices[0]; ++choice[0])
        for (choice[1] = 0; choice[1] < choices[1]; ++choice[1])
            for (choice[2] = 0; choice[2] < choices[2]; ++choice[2]) {
                double x[3];
                int inside[3], count = 0;
                for (int k = 0; k < 3; ++k) {
                    x[k] = choice[k] == 1 ? f.hi[k] : f.lo[k];
                    if (choice[k] == 2) inside[count++] = k;
                }
                if (count && !stationary(&f, inside, count, x)) continue;
                const double value = quadratic_value(&f, x);
                if (!(value <= best)) best = value; /* not a number must not be lost */
            }
    return best;
}

static mr_interval quadratic_range(mr_quadratic *f) {
    mr_interval range;
    range.hi = quadratic_max(f);
    for (int k = 0; k < 3; ++k) f->g[k] = -f->g[k];
    for (int k = 0; k < 6; ++k) f->Q[k] = -f->Q[k];
    range.lo = -quadratic_max(f);
    return range;
}

/* Links, joint axes and points in the base frame. */
static void forward_poses(const mr_model *model, const mr_link *links, mr_pose *poses) {
    for (int32_t i = 0; i < model->j; ++i) {
        const mr_link *link = &links[i];
        const double *lever = model->before[i].p;
        mr_pose *pose = &poses[i];
        double arm[3];
        if (model->parent[i] < 0) {
            for (int k = 0; k < 9; ++k) pose->R[k] = link->R[k];
            mr_copy(lever, pose->point);
        } else {
            const mr_pose *parent = &poses[model->parent[i]];
            mr_multiply(parent->R, link->R, pose->R);
            mr_rotate(parent->R, lever, pose->point);
            mr_add(parent->origin, pose->point);
        }
        mr_rotate(pose->R, link->z, pose->axis);
        mr_rotate(pose->R, link->p, arm);
        for (int k = 0; k < 3; ++k) pose->origin[k] = pose->point[k] + arm[k];
    }
}

/* What one uncertain body has in common for all joints that carry it. */
typedef struct {
    mr_motion motion;
    double L[9];        /* (16) */
    double e[3];        /* acceleration of the nominal COM, body axes */
    double R[9];        /* body to base */
    double com[3];      /* nominal COM from the base origin, base axes */
} mr_uncertain_body;

static void uncertain_body(const mr_model *model, const mr_bounds *bounds, const mr_link *links,
                           const mr_pose *poses, int32_t b, mr_uncertain_body *body) {
    const mr_pose *pose = &poses[model->body_joint[b]];
    const mr_transform *T = &model->placement[b];
    const double *com = bounds->nominal.com + 3 * b;
    double arm[3];
    mr_body_motion(model, links, b, &body->motion);
    mr_acceleration_matrix(body->motion.w, body->motion.wa, body->motion.dw, body->L);
    mr_rotate(body->L, com, body->e);
    mr_add(body->motion.a, body->e);
    if (mr_is_identity(T->R))
        for (int k = 0; k < 9; ++k) body->R[k] = pose->R[k];
    else
        mr_multiply(pose->R, T->R, body->R);
    mr_rotate(pose->R, T->p, body->com);
    mr_add(pose->origin, body->com);
    mr_rotate(body->R, com, arm);
    mr_add(arm, body->com);
}

/* Range of one body's torque on one joint, less the nominal, (18). */
static mr_interval deviation(const mr_model *model, const mr_bounds *bounds,
                             const mr_uncertain_body *body, const mr_pose *pose, int32_t b,
                             int32_t joint) {
    const mr_parameters *nominal = &bounds->nominal;
    const mr_parameters *lower = &bounds->lower, *upper = &bounds->upper;
    const mr_motion *m = &body->motion;
    mr_quadratic f;
    double s[3], f0;
    mr_unrotate(body->R, pose->axis, s);
    for (int k = 0; k < 3; ++k) {
        f.lo[k] = lower->com[3 * b + k] - nominal->com[3 * b + k];
        f.hi[k] = upper->com[3 * b + k] - nominal->com[3 * b + k];
    }
    mr_interval inertia = {0.0, 0.0};
    if (model->joint_type[joint] == MR_REVOLUTE) {
        double x[3], arm[3], sx[3], es[3], swa[3];
        for (int k = 0; k < 3; ++k) arm[k] = body->com[k] - pose->point[k];
        mr_unrotate(body->R, arm, x);
        mr_cross(s, x, sx);
        f0 = mr_dot(sx, body->e);
        mr_unrotate(body->L, sx, f.g);
        mr_cross(body->e, s, es);
        mr_add(es, f.g);
        /* sym([s]x' L): row i of [s]x' L is column i of [s]x, crossed into the columns of L */
        const double *L = body->L;
        double P[9];
        for (int k = 0; k < 3; ++k) {
            P[k] = s[2] * L[3 + k] - s[1] * L[6 + k];
            P[3 + k] = s[0] * L[6 + k] - s[2] * L[k];
            P[6 + k] = s[1] * L[k] - s[0] * L[3 + k];
        }
        f.Q[0] = P[0];
        f.Q[1] = 0.5 * (P[1] + P[3]);
        f.Q[2] = 0.5 * (P[2] + P[6]);
        f.Q[3] = P[4];
        f.Q[4] = 0.5 * (P[5] + P[7]);
        f.Q[5] = P[8];
        /* < sym(s dw' + (s x wa) w'), I >: off-diagonal entries count twice */
        mr_cross(s, m->wa, swa);
        const double W[6] = {
            s[0] * m->dw[0] + swa[0] * m->w[0],
            s[0] * m->dw[1] + s[1] * m->dw[0] + swa[0] * m->w[1] + swa[1] * m->w[0],
            s[0] * m->dw[2] + s[2] * m->dw[0] + swa[0] * m->w[2] + swa[2] * m->w[0],
            s[1] * m->dw[1] + swa[1] * m->w[1],
            s[1] * m->dw[2] + s[2] * m->dw[1] + swa[1] * m->w[2] + swa[2] * m->w[1],
            s[2] * m->dw[2] + swa[2] * m->w[2],
        };
        for (int k = 0; k < 6; ++k) {
            const double I0 = nominal->inertia[6 * b + k];
            inertia = mr_i_add(inertia,
                               mr_i_scale(W[k], (mr_interval){lower->inertia[6 * b + k] - I0,
                                                              upper->inertia[6 * b + k] - I0}));
        }
    } else {
        f0 = mr_dot(s, body->e);
        mr_unrotate(body->L, s, f.g);
        for (int k = 0; k < 6; ++k) f.Q[k] = 0.0;
    }

    const mr_interval range = quadratic_range(&f);
    const double light = lower->mass[b] - nominal->mass[b];
    const double heavy = upper->mass[b] - nominal->mass[b];
    const double hi_light = light * f0 + lower->mass[b] * range.hi;
    const double hi_heavy = heavy * f0 + upper->mass[b] * range.hi;
    const double lo_light = light * f0 + lower->mass[b] * range.lo;
    const double lo_heavy = heavy * f0 + upper->mass[b] * range.lo;
    return (mr_interval){inertia.lo + (lo_light < lo_heavy ? lo_light : lo_heavy),
                         inertia.hi + (hi_light > hi_heavy ? hi_light : hi_heavy)};
}

void mr_hull_deviation(const mr_model *model, const mr_bounds *bounds, const mr_link *links,
                       mr_pose *poses, double *lo, double *hi) {
    for (int32_t i = 0; i < model->j; ++i) lo[i] = hi[i] = 0.0;
    if (bounds->uncertain_count == 0) return;
    forward_poses(model, links, poses);
    for (int32_t k = 0; k < bounds->uncertain_count; ++k) {
        const int32_t b = bounds->uncertain[k];
        mr_uncertain_body body;
        if (model->body_joint[b] < 0) continue;
        uncertain_body(model, bounds, links, poses, b, &body);
        for (int32_t j = model->body_joint[b]; j >= 0; j = model->parent[j]) {
            const mr_interval d = deviation(model, bounds, &body, &poses[j], b, j);
            lo[j] += d.lo;
            hi[j] += d.hi;
        }
    }
}
