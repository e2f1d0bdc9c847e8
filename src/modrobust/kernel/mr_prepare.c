/* Constants precomputed at load: kinds and norms of the transforms, and each body's box as
 * differences from nominal. */
#include "mr_internal.h"
#include "mr_rounding.h"

#define DOUBLES(type) (sizeof(type) / sizeof(double))

/* Norms are rounded up by more than their own rounding. */
static double norm_up(int count, const double *x) {
    double largest = 0.0, sum = 0.0;
    for (int k = 0; k < count; ++k) largest = fabs(x[k]) > largest ? fabs(x[k]) : largest;
    if (!(largest > 0.0) || isinf(largest)) return largest;
    for (int k = 0; k < count; ++k) sum += (x[k] / largest) * (x[k] / largest);
    return largest * sqrt(sum) * (1.0 + 0x1p-48);
}

static double inertia_norm(const double I[6]) {
    const double full[9] = {I[0], I[1], I[2], I[1], I[3], I[4], I[2], I[4], I[5]};
    return norm_up(9, full);
}

static double kind_of(const mr_transform *T) {
    static const double one[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    for (int k = 0; k < 9; ++k) /* all of them: a rotation by 1e-9 has ones on its diagonal */
        if (T->R[k] != one[k]) return MR_GENERAL;
    return T->p[0] == 0.0 && T->p[1] == 0.0 && T->p[2] == 0.0 ? MR_IDENTITY : MR_SHIFT;
}

/* |R' R - 1| in the Frobenius norm, 0 where it is no more than nearest doubles of a rotation have.
 * Entries are cut in two, so that the products of their upper parts are exact, and what their sums
 * lose is kept. */
static double defect_of(const mr_transform *T) {
    double defect[9];
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            double upper = r == c ? -1.0 : 0.0, rest = 0.0;
            for (int k = 0; k < 9; k += 3) {
                const double x = (double)(float)T->R[k + r], y = (double)(float)T->R[k + c];
                const double product = x * y, sum = upper + product, added = sum - upper;
                rest += (upper - (sum - added)) + (product - added);
                rest += x * (T->R[k + c] - y) + (T->R[k + r] - x) * T->R[k + c];
                upper = sum;
            }
            defect[3 * r + c] = upper + rest;
        }
    const double size = norm_up(9, defect);
    return size <= MR_NO_DEFECT * MR_U ? 0.0 : size;
}

/* 0 times any finite number is 0, and not a number otherwise. */
static double nonfinite_flag_of(const mr_transform *T) {
    double nonfinite_flag = 0.0;
    for (int k = 0; k < 9; ++k) nonfinite_flag += 0.0 * T->R[k];
    for (int k = 0; k < 3; ++k) nonfinite_flag += 0.0 * T->p[k];
    return nonfinite_flag;
}

size_t mr_precomputed_size(const mr_model *model) {
    return DOUBLES(mr_model_constants) + (size_t)model->j * DOUBLES(mr_joint_constants) +
           13 * mr_body_stride(model);
}

void mr_do_precompute_model(const mr_model *model, double *precomputed) {
    const size_t stride = mr_body_stride(model);
    mr_model_constants *whole = (mr_model_constants *)precomputed;
    mr_joint_constants *joints = (mr_joint_constants *)(whole + 1);
    double *placements = (double *)(joints + model->j);
    *whole = (mr_model_constants){0.0, 0.0, 1.0, 0.0, MR_IDENTITY, 1.0, 0.0, 0.0};
    for (int k = 0; k < 3; ++k) whole->nonfinite_flag += 0.0 * model->gravity[k];
    for (int32_t i = 0; i < model->j; ++i) {
        const mr_transform *before = &model->before[i], *after = &model->after[i];
        double depth = 1.0;
        for (int32_t k = model->parent[i]; k >= 0; k = model->parent[k]) depth += 1.0;
        if (depth > whole->depth) whole->depth = depth;
        if (model->parent[i] != i - 1) whole->serial = 0.0;
        if (model->joint_type[i] == MR_PRISMATIC) whole->prismatic = 1.0;
        whole->defect += defect_of(before) + defect_of(after);
        whole->nonfinite_flag += nonfinite_flag_of(before) + nonfinite_flag_of(after) +
                                 0.0 * model->gear_ratio[i] + 0.0 * model->coulomb_speed[i];
        joints[i].before = kind_of(before);
        joints[i].before_norm = norm_up(3, before->p);
        joints[i].lever_norm = norm_up(3, after->p);
        mr_unrotate(after->R, after->p, joints[i].lever); /* A1:9 */
    }
    for (size_t k = 0; k < 13 * stride; ++k) placements[k] = 0.0;
    for (int32_t b = 0; b < model->b; ++b) {
        const mr_transform *T = &model->placement[b];
        whole->defect += defect_of(T);
        whole->nonfinite_flag += nonfinite_flag_of(T);
        if (kind_of(T) != MR_IDENTITY) whole->placements = MR_GENERAL;
        if (model->body_joint[b] != b) whole->aligned = 0.0;
        for (size_t k = 0; k < 9; ++k) placements[k * stride + (size_t)b] = T->R[k];
        for (size_t k = 0; k < 3; ++k) placements[(9 + k) * stride + (size_t)b] = T->p[k];
        if (model->inertia_about[b] != MR_ABOUT_FRAME) continue;
        placements[12 * stride + (size_t)b] = whole->framed = 1.0;
    }
}

/* I <- I - m (c'c 1 - c c'), six entries, (16f) */
static void to_com(double m, const double c[3], double I[6]) {
    I[0] -= m * (c[1] * c[1] + c[2] * c[2]);
    I[1] += m * (c[0] * c[1]);
    I[2] += m * (c[0] * c[2]);
    I[3] -= m * (c[0] * c[0] + c[2] * c[2]);
    I[4] += m * (c[1] * c[2]);
    I[5] -= m * (c[0] * c[0] + c[1] * c[1]);
}

void mr_point_of(const mr_model *model, const mr_parameters *parameters, double *point) {
    const size_t stride = mr_body_stride(model);
    for (size_t k = 0; k < MR_POINT * stride; ++k) point[k] = 0.0;
    for (size_t b = 0; b < (size_t)model->b; ++b) {
        const double m = parameters->mass[b], *c = parameters->com + 3 * b;
        double I[6];
        for (size_t k = 0; k < 6; ++k) I[k] = parameters->inertia[6 * b + k];
        if (model->inertia_about[b] == MR_ABOUT_FRAME) to_com(m, c, I);
        point[b] = m;
        for (size_t k = 0; k < 3; ++k) point[(1 + k) * stride + b] = c[k];
        for (size_t k = 0; k < 6; ++k) point[(4 + k) * stride + b] = I[k];
    }
}

/* [lo, hi] less nominal as shift +- radius. A shift that only rounding made goes into the radius.
 * The differences' own rounding is relative to them and part of (26). */
static void centre(double lo, double nominal, double hi, double *shift, double *radius) {
    const double below = lo - nominal, above = hi - nominal;
    double middle = 0.5 * (below + above);
    if (fabs(middle) <= 0x1p-40 * (above - below)) middle = 0.0;
    const double up = above - middle, down = middle - below;
    *shift = middle;
    *radius = (up > down ? up : down) * (1.0 + 0x1p-50);
}

static mr_body_box box_of(const mr_bounds *bounds, int32_t b) {
    const mr_parameters *l = &bounds->lower, *c = &bounds->nominal, *h = &bounds->upper;
    mr_body_box box;
    box.off_centre = box.com_uncertain = box.inertia_uncertain = 0.0;
    for (int k = 0; k < 3; ++k) {
        const int32_t e = 3 * b + k;
        centre(l->com[e], c->com[e], h->com[e], &box.com_shift[k], &box.com_radius[k]);
        if (box.com_shift[k] != 0.0) box.off_centre = 1.0;
        if (box.com_shift[k] != 0.0 || box.com_radius[k] != 0.0) box.com_uncertain = 1.0;
    }
    for (int k = 0; k < 6; ++k) {
        const int32_t e = 6 * b + k;
        centre(l->inertia[e], c->inertia[e], h->inertia[e], &box.inertia_shift[k],
               &box.inertia_radius[k]);
        if (box.inertia_shift[k] != 0.0) box.off_centre = 1.0;
        if (box.inertia_shift[k] != 0.0 || box.inertia_radius[k] != 0.0)
            box.inertia_uncertain = 1.0;
    }
    centre(l->mass[b], c->mass[b], h->mass[b], &box.mass_shift, &box.mass_radius);
    if (box.mass_shift != 0.0) box.off_centre = 1.0;
    box.mass_middle = c->mass[b] + box.mass_shift;
    return box;
}

/* Sums over the bodies that a joint carries; X is the distance from the base to the COM, x that
 * from a frame. Force m (a + k X), moment m (a + k X) x + k |I|, and their changes over the box. */
typedef struct {
    double reach; /* from the base to the link frame, prismatic joints at zero */
    double m, mX, mx, mXx; /* mXx holds |I| too */
    double dm, dmX, dmXX;  /* dmX holds m r too, and dmXX all else that k multiplies */
} subtree_sums;

/* Adds body b to its link's sums; without a box nothing changes. Returns how far its COM may be
 * from the link frame. */
static double add_body(const mr_model *model, const mr_parameters *at, const mr_bounds *bounds,
                       int32_t b, subtree_sums *s) {
    const double m = fabs(at->mass[b]), c = norm_up(3, at->com + 3 * b);
    const double x = norm_up(3, model->placement[b].p) + c;
    const double X = s->reach + x;
    double I = inertia_norm(at->inertia + 6 * b);
    if (model->inertia_about[b] == MR_ABOUT_FRAME) I += 1.5 * m * c * c; /* moved to the COM */
    s->m += m;
    s->mX += m * X;
    s->mx += m * x;
    s->mXx += m * X * x + I;
    if (!bounds) return x;
    const mr_parameters *l = &bounds->lower, *h = &bounds->upper;
    double com[3], inertia[6];
    for (int32_t k = 0; k < 3; ++k) {
        const int32_t e = 3 * b + k;
        com[k] = fmax(h->com[e] - at->com[e], at->com[e] - l->com[e]);
    }
    for (int32_t k = 0; k < 6; ++k) {
        const int32_t e = 6 * b + k;
        inertia[k] = fmax(h->inertia[e] - at->inertia[e], at->inertia[e] - l->inertia[e]);
    }
    const double dm = fmax(h->mass[b] - m, m - l->mass[b]), r = norm_up(3, com);
    s->dm += dm;
    s->dmX += dm * X + h->mass[b] * r;
    s->dmXX += dm * X * X + h->mass[b] * r * (r + 2.0 * X) + inertia_norm(inertia);
    return x + r;
}

/* x of all sums grows by a lever. */
static void shift_lever(double lever, subtree_sums *s) {
    s->mx += lever * s->m;
    s->mXx += lever * s->mX;
}

/* Rates times sizes, (26). Errors grow with depth, are there once, and with the bodies and joints
 * that are summed; infinite where the proof ends. work holds mr_slack_work doubles. */
static void slack_constants(const mr_model *model, const mr_parameters *at,
                            const mr_bounds *bounds, double *work, mr_slack_factors *factors,
                            mr_slack_constants *constants) {
    const mr_joint_constants *joints = mr_of_joints(model);
    const double depth = mr_of_model(model)->depth, summed = model->b + 2.0 * model->j;
    const double defect = MR_DEFECTS * mr_of_model(model)->defect / MR_U;
    const double unit = MR_U * MR_SECOND_ORDER;
    double nominal = (MR_NOMINAL_JOINT * depth + MR_NOMINAL_ONCE + summed + defect) * unit;
    double change = (MR_CHANGE_JOINT * depth + MR_CHANGE_ONCE + summed + defect) * unit;
    if (!(change <= MR_RATE_MAX)) nominal = change = INFINITY;
    subtree_sums *all = (subtree_sums *)work;
    for (int32_t i = 0; i < model->j; ++i) {
        const int32_t parent = model->parent[i]; /* distances start at the first joint */
        const double before = parent < 0 ? 0.0 : all[parent].reach + joints[i].before_norm;
        all[i] = (subtree_sums){before + joints[i].lever_norm, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    }
    *factors = (mr_slack_factors){0.0, 0.0};
    for (int32_t b = 0; b < model->b; ++b) {
        if (model->body_joint[b] < 0) continue;
        subtree_sums *s = &all[model->body_joint[b]];
        const double reach = s->reach + add_body(model, at, bounds, b, s);
        if (reach > factors->reach) factors->reach = reach;
    }
    for (int32_t i = model->j - 1; i >= 0; --i) {
        subtree_sums *s = &all[i];
        shift_lever(joints[i].lever_norm, s);
        const double m = nominal * s->m + change * s->dm, mX = nominal * s->mX + change * s->dmX;
        if (model->joint_type[i] == MR_REVOLUTE)
            constants[i] = (mr_slack_constants){nominal * s->mx + change * s->dmX, m,
                                                nominal * s->mXx + change * s->dmXX,
                                                nominal * s->mx + mX + change * s->dmX};
        else
            constants[i] = (mr_slack_constants){m, 0.0, mX, m};
        const double mass_max = s->m + s->dm + s->mXx + s->dmXX;
        if (mass_max > factors->mass_max) factors->mass_max = mass_max;
        if (model->parent[i] < 0) continue;
        subtree_sums *parent = &all[model->parent[i]];
        shift_lever(joints[i].before_norm, s);
        parent->m += s->m;
        parent->mX += s->mX;
        parent->mx += s->mx;
        parent->mXx += s->mXx;
        parent->dm += s->dm;
        parent->dmX += s->dmX;
        parent->dmXX += s->dmXX;
    }
}

size_t mr_slack_work(const mr_model *model) { return (size_t)model->j * DOUBLES(subtree_sums); }

void mr_point_slack(const mr_model *model, const mr_parameters *parameters, double *work,
                    mr_slack_factors *factors, mr_slack_constants *constants) {
    slack_constants(model, parameters, NULL, work, factors, constants);
}

size_t mr_prepared_size(const mr_model *model) {
    return DOUBLES(mr_slack_factors) + (MR_POINT + MR_RANGE) * mr_body_stride(model) +
           (size_t)model->j * DOUBLES(mr_slack_constants) +
           (size_t)model->b * DOUBLES(mr_body_box) + mr_slack_work(model);
}

static int is_box(size_t count, double least, const double *lo, const double *nominal,
                  const double *hi) {
    for (size_t k = 0; k < count; ++k) /* a comparison with what is not a number is false */
        if (!(least <= lo[k] && lo[k] <= nominal[k] && nominal[k] <= hi[k] && hi[k] <= DBL_MAX))
            return 0;
    return 1;
}

static int is_bounds(const mr_model *model, const mr_bounds *bounds) {
    const mr_parameters *l = &bounds->lower, *c = &bounds->nominal, *h = &bounds->upper;
    const size_t b = (size_t)model->b, j = (size_t)model->j, n = (size_t)model->n;
    const double *d_lo = bounds->disturbance_lo, *d_hi = bounds->disturbance_hi;
    return is_box(b, 0.0, l->mass, c->mass, h->mass) &&
           is_box(3 * b, -DBL_MAX, l->com, c->com, h->com) &&
           is_box(6 * b, -DBL_MAX, l->inertia, c->inertia, h->inertia) &&
           is_box(j, 0.0, l->rotor_inertia, c->rotor_inertia, h->rotor_inertia) &&
           is_box(j, 0.0, l->viscous, c->viscous, h->viscous) &&
           is_box(j, 0.0, l->coulomb, c->coulomb, h->coulomb) &&
           (!d_lo || is_box(n, -DBL_MAX, d_lo, d_lo, d_hi));
}

/* [lo, hi] as middle +- radius, which contains it. */
static void middle_of(double lo, double hi, double *middle, double *radius) {
    *middle = lo == hi ? lo : 0.5 * lo + 0.5 * hi;
    *radius = fmax(hi - *middle, *middle - lo) * (1.0 + 0x1p-50);
}

/* (MR_RANGE, b padded) */
static void ranges_of(const mr_model *model, const mr_bounds *bounds, const subtree_sums *links,
                      double *ranges) {
    const mr_parameters *l = &bounds->lower, *h = &bounds->upper;
    const size_t stride = mr_body_stride(model);
    for (size_t k = 0; k < MR_RANGE * stride; ++k) ranges[k] = 0.0;
    for (int32_t b = 0; b < model->b; ++b) {
        const int32_t joint = model->body_joint[b];
        double lo[MR_POINT], hi[MR_POINT], middle[MR_POINT], radius[MR_POINT], most[MR_POINT];
        lo[0] = l->mass[b];
        hi[0] = h->mass[b];
        for (int32_t k = 0; k < 3; ++k) {
            lo[1 + k] = l->com[3 * b + k];
            hi[1 + k] = h->com[3 * b + k];
        }
        for (int32_t k = 0; k < 6; ++k) {
            lo[4 + k] = l->inertia[6 * b + k];
            hi[4 + k] = h->inertia[6 * b + k];
        }
        for (size_t k = 0; k < MR_POINT; ++k) {
            middle_of(lo[k], hi[k], &middle[k], &radius[k]);
            most[k] = fabs(middle[k]) + radius[k];
            ranges[k * stride + (size_t)b] = middle[k];
            ranges[(MR_POINT + k) * stride + (size_t)b] = radius[k];
        }
        double *sizes = ranges + 2 * MR_POINT * stride + (size_t)b;
        sizes[0] = (joint < 0 ? 0.0 : links[joint].reach) + norm_up(3, model->placement[b].p) +
                   norm_up(3, most + 1) + 4.0 * norm_up(3, radius + 1);
        sizes[stride] = 2.0 * norm_up(3, most + 1);
        sizes[2 * stride] = inertia_norm(most + 4) + 4.0 * inertia_norm(radius + 4);
    }
}

void mr_do_prepare(const mr_model *model, const mr_bounds *bounds, double *prepared) {
    const size_t stride = mr_body_stride(model);
    mr_slack_factors *factors = (mr_slack_factors *)prepared;
    double *point = (double *)(factors + 1), *ranges = point + MR_POINT * stride;
    mr_slack_constants *slack = (mr_slack_constants *)(ranges + MR_RANGE * stride);
    mr_body_box *boxes = (mr_body_box *)(slack + model->j);
    subtree_sums *work = (subtree_sums *)(boxes + model->b);
    mr_point_of(model, &bounds->nominal, point);
    slack_constants(model, &bounds->nominal, bounds, (double *)work, factors, slack);
    if (!is_bounds(model, bounds) || mr_of_model(model)->nonfinite_flag != 0.0)
        factors->reach = NAN;
    ranges_of(model, bounds, work, ranges);
    for (int32_t k = 0; k < bounds->uncertain_count; ++k)
        boxes[k] = box_of(bounds, bounds->uncertain[k]);
}
