/* Constants folded at load: kinds and norms of the transforms, and each body's box as differences
 * from nominal. */
#include "mr_internal.h"
#include "mr_rounding.h"

#define DOUBLES(type) (sizeof(type) / sizeof(double))

/* Norms are rounded up by more than their own rounding. */
static double norm_up(int count, const double *x) {
    double largest = 0.0, sum = 0.0;
    for (int k = 0; k < count; ++k) largest = fabs(x[k]) > largest ? fabs(x[k]) : largest;
    if (!(largest > 0.0) || isinf(largest)) return largest;
    for (int k = 0; k < count; ++k) sum += (x[k] / largest) * (x[k] / largest);
    return largest * sqrt(sum) * (1.0 + 0x1p-48) + MR_TINY;
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

/* An upper bound of |R' R - 1|, itself rounded. */
static double defect_of(const mr_transform *T) {
    double defect[9];
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            defect[3 * r + c] = T->R[r] * T->R[c] + T->R[3 + r] * T->R[3 + c] +
                                T->R[6 + r] * T->R[6 + c] - (r == c ? 1.0 : 0.0);
    return norm_up(9, defect) + 0x1p-50;
}

size_t mr_folded_size(const mr_model *model) {
    return DOUBLES(mr_model_constants) + (size_t)model->j * DOUBLES(mr_joint_constants) +
           (size_t)model->b * DOUBLES(mr_body_constants);
}

void mr_do_fold(const mr_model *model, double *folded) {
    mr_model_constants *whole = (mr_model_constants *)folded;
    mr_joint_constants *joints = (mr_joint_constants *)(whole + 1);
    mr_body_constants *bodies = (mr_body_constants *)(joints + model->j);
    *whole = (mr_model_constants){0.0, 0.0, 1.0, 0.0};
    for (int32_t i = 0; i < model->j; ++i) {
        const mr_transform *before = &model->before[i], *after = &model->after[i];
        double depth = 1.0;
        for (int32_t k = model->parent[i]; k >= 0; k = model->parent[k]) depth += 1.0;
        if (depth > whole->depth) whole->depth = depth;
        if (model->parent[i] != i - 1) whole->serial = 0.0;
        if (model->joint_type[i] == MR_PRISMATIC) whole->prismatic = 1.0;
        whole->defect += defect_of(before) + defect_of(after);
        joints[i].before = kind_of(before);
        joints[i].before_norm = norm_up(3, before->p);
        joints[i].lever_norm = norm_up(3, after->p);
        mr_unrotate(after->R, after->p, joints[i].lever); /* line 9 */
    }
    for (int32_t b = 0; b < model->b; ++b) {
        const mr_transform *T = &model->placement[b];
        whole->defect += defect_of(T);
        bodies[b].placement = kind_of(T);
        bodies[b].lever_norm = norm_up(3, T->p);
    }
}

mr_body_norms mr_norms_of(const mr_parameters *parameters, int32_t b) {
    return (mr_body_norms){parameters->mass[b], norm_up(3, parameters->com + 3 * b),
                           inertia_norm(parameters->inertia + 6 * b)};
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
    double reach[3], inertia[6];
    box.off_centre = 0.0;
    for (int k = 0; k < 3; ++k) {
        const int32_t e = 3 * b + k;
        centre(l->com[e], c->com[e], h->com[e], &box.com_shift[k], &box.com_radius[k]);
        reach[k] = fabs(box.com_shift[k]) + box.com_radius[k];
        if (box.com_shift[k] != 0.0) box.off_centre = 1.0;
    }
    for (int k = 0; k < 6; ++k) {
        const int32_t e = 6 * b + k;
        centre(l->inertia[e], c->inertia[e], h->inertia[e], &box.inertia_shift[k],
               &box.inertia_radius[k]);
        inertia[k] = fabs(box.inertia_shift[k]) + box.inertia_radius[k];
        if (box.inertia_shift[k] != 0.0) box.off_centre = 1.0;
    }
    centre(l->mass[b], c->mass[b], h->mass[b], &box.mass_shift, &box.mass_radius);
    if (box.mass_shift != 0.0) box.off_centre = 1.0;
    box.mass_middle = c->mass[b] + box.mass_shift;
    box.com_norm = norm_up(3, reach);
    box.mass_change = fabs(box.mass_shift) + box.mass_radius;
    box.inertia_norm = inertia_norm(inertia);
    box.mass_largest = c->mass[b] + box.mass_change;
    return box;
}

size_t mr_prepared_size(const mr_model *model) {
    return (size_t)model->b * (2 * DOUBLES(mr_body_norms) + DOUBLES(mr_body_box));
}

void mr_do_prepare(const mr_model *model, const mr_bounds *bounds, double *prepared) {
    mr_body_norms *nominal = (mr_body_norms *)prepared, *largest = nominal + model->b;
    mr_body_box *boxes = (mr_body_box *)(largest + model->b);
    for (int32_t b = 0; b < model->b; ++b) {
        const mr_body_norms lower = mr_norms_of(&bounds->lower, b);
        const mr_body_norms upper = mr_norms_of(&bounds->upper, b);
        nominal[b] = mr_norms_of(&bounds->nominal, b);
        /* each entry of a box is at most the sum of its ends' sizes */
        largest[b] = (mr_body_norms){upper.mass, lower.com + upper.com,
                                     lower.inertia + upper.inertia};
    }
    for (int32_t k = 0; k < bounds->uncertain_count; ++k)
        boxes[k] = box_of(bounds, bounds->uncertain[k]);
}
