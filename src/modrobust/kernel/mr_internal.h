/* What the kernel's files share and nobody else sees. */
#ifndef MR_INTERNAL_H
#define MR_INTERNAL_H

#include "mr_kernel.h"
#include "mr_vector.h"

#if FLT_EVAL_METHOD != 0
#error "modrobust: double arithmetic must be binary64 (on 32-bit x86: -msse2 -mfpmath=sse)"
#endif

/* How a constant transform acts; a D-H chain has only identities before its joints. */
enum { MR_GENERAL = 0, MR_SHIFT = 1, MR_IDENTITY = 2 };

/* Arrays of joints and bodies are padded to whole registers of the widest kind. */
static inline size_t mr_padded(int32_t count) { return ((size_t)count + 7) / 8 * 8; }
static inline size_t mr_joint_stride(const mr_model *model) { return mr_padded(model->j); }
static inline size_t mr_body_stride(const mr_model *model) { return mr_padded(model->b); }

/* The first double from here on that starts a register of the widest kind. */
static inline double *mr_align(double *memory) {
    return memory + (64 - (uintptr_t)memory % 64) % 64 / sizeof(double);
}

/* Constants of a model, all doubles: the header, (j) of the next, then the placements of the
 * bodies component by component (12, b padded) and what their tensors are about (b padded). */
typedef struct {
    double depth;      /* joints on the longest path from the base to a link */
    double defect;     /* sum of all rotation matrices' distances from an orthonormal one */
    double serial;     /* 1 where every joint's parent is the joint before it */
    double prismatic;  /* 1 where a joint is prismatic */
    double placements; /* how the placements of the bodies act, all of them */
    double aligned;    /* 1 where body k moves with joint k, for all bodies */
    double framed;     /* 1 where the tensor of a body is about its frame */
    double nonfinite_flag; /* 0, or not a number where a constant is not finite */
} mr_model_constants;

typedef struct {
    double before;      /* how the transform before the joint acts */
    double lever[3];    /* joint frame's origin to link frame's, in link axes, at q = 0 */
    double before_norm; /* |p| of the transform before */
    double lever_norm;
} mr_joint_constants;

static inline const mr_model_constants *mr_of_model(const mr_model *model) {
    return (const mr_model_constants *)model->precomputed;
}

static inline const mr_joint_constants *mr_of_joints(const mr_model *model) {
    return (const mr_joint_constants *)(mr_of_model(model) + 1);
}

/* R row by row, then p. */
static inline const double *mr_placements(const mr_model *model) {
    return (const double *)(mr_of_joints(model) + model->j);
}

/* (b padded) 0 for a tensor about the COM, 1 for one about the body frame's origin. */
static inline const double *mr_abouts(const mr_model *model) {
    return mr_placements(model) + 12 * mr_body_stride(model);
}

/* A parameter point for the pass, component by component (10, b padded): mass, com, and inertia
 * about the COM, whatever the body's tensor is about. */
#define MR_POINT 10
void mr_point_of(const mr_model *model, const mr_parameters *parameters, double *point);

/* Rounding of joint i's torque, (26): factors of the acceleration's and rotation's sizes, more where
 * prismatic joints reach out. */
typedef struct {
    double acceleration, acceleration_prismatic, rotation, rotation_prismatic;
} mr_slack_constants;

/* Largest factors of any product: the distance from the base to a COM, and mass or inertia. */
typedef struct {
    double reach, mass_max;
} mr_slack_factors;

/* What an interval pass needs to know of the bodies, component by component (23, b padded): the
 * middle of the box of parameters as given, its radius, and three sizes for (27): the distance from
 * the base to the farthest COM and four radii, twice the COM's, the largest inertia and four radii. */
#define MR_RANGE (2 * MR_POINT + 3)

/* An uncertain body's box as differences from nominal: shift +- radius. */
typedef struct {
    double off_centre;    /* 0 where every shift is zero */
    double com_shift[3], com_radius[3];
    double mass_shift, mass_radius, mass_middle;
    double inertia_shift[6], inertia_radius[6];
    double com_uncertain, inertia_uncertain; /* 0 where there is no shift and no radius */
} mr_body_box;

/* mr_bounds.prepared: the factors, the nominal point, the ranges, slack (j), and the boxes of the
 * uncertain bodies. */
static inline const mr_slack_factors *mr_factors(const mr_bounds *bounds) {
    return (const mr_slack_factors *)bounds->prepared;
}

/* 0 where mr_prepare found numbers that are not finite, or no box: nothing can be said then. */
static inline int mr_is_sound(const mr_bounds *bounds) {
    return isfinite(mr_factors(bounds)->reach);
}

static inline const double *mr_nominal_point(const mr_bounds *bounds) {
    return (const double *)(mr_factors(bounds) + 1);
}

static inline const double *mr_ranges(const mr_model *model, const mr_bounds *bounds) {
    return mr_nominal_point(bounds) + MR_POINT * mr_body_stride(model);
}

static inline const mr_slack_constants *mr_hull_slack_constants(const mr_model *model,
                                                                const mr_bounds *bounds) {
    return (const mr_slack_constants *)(mr_ranges(model, bounds) +
                                        MR_RANGE * mr_body_stride(model));
}

static inline const mr_body_box *mr_boxes(const mr_model *model, const mr_bounds *bounds) {
    return (const mr_body_box *)(mr_hull_slack_constants(model, bounds) + model->j);
}

/* One link after the forward recursion of Algorithm 1, in its own frame. */
typedef struct {
    MR_REAL R[9]; /* link to parent link, A1:6 */
    MR_REAL p[3]; /* joint frame origin to link frame origin, A1:9 */
} mr_link;

/* Components of the motion of links and bodies, in arrays: angular velocity (A1:13 and A1:18), the
 * auxiliary one (A1:14, A1:19), angular acceleration (A1:15, A1:20), acceleration less gravity
 * (A1:16, A1:21). */
enum { MR_W = 0, MR_WA = 3, MR_DW = 6, MR_A = 9, MR_MOTION = 12 };
/* Those of a body go on: L of (16), acceleration of the nominal COM less gravity, and force and
 * moment in link axes about the link's origin. */
enum { MR_L = 12, MR_E = 21, MR_F = 24, MR_N = 27, MR_BODY = 30 };
/* Their boxes, (12), which `ianea` puts where NE* has left L and what depends on it. */
enum { MR_BOX = MR_L };

typedef struct {
    MR_REAL f[3], n[3];
} mr_wrench;

typedef struct {
    MR_REAL f[3], f_rad[3], n[3], n_rad[3]; /* middle and radius */
} mr_wrench_box;

/* Upper bounds of Euclidean norms at one state, (25). */
typedef struct {
    MR_REAL rotation; /* |dw| + |w| |wa| of every link, and what their errors grow from */
    MR_REAL acceleration; /* the acceleration of every link's origin, likewise */
    MR_REAL prismatic_reach; /* what prismatic joints add to any distance */
    MR_REAL underflow; /* what underflow may change in an acceleration or a lever's moment */
    MR_REAL mimic_angle; /* sum of what the mimic joints' angles are off, in units of u */
} mr_motion_size;

/* Joint and link seen from the base frame, for the hull. */
typedef struct {
    MR_REAL R[9];      /* link to base */
    MR_REAL origin[3]; /* of the link frame */
} mr_pose;

/* What a function is asked about, (j) each. Where dq_a and ddq_a were computed, the sizes are those
 * of the terms that they are sums of, because a sum's rounding is relative to its terms. */
typedef struct {
    const MR_REAL *q, *dq, *dq_a, *ddq_a;
    const MR_REAL *dq_a_size, *ddq_a_size; /* NULL where dq_a and ddq_a are given */
} mr_state;

static inline MR_REAL mr_acceleration_size(const mr_state *state, int32_t i) {
    return state->ddq_a_size ? state->ddq_a_size[i] : MR_ABS(state->ddq_a[i]);
}

/* The caller's working memory, cut into arrays. */
typedef struct {
    mr_link *links;     /* (j) */
    MR_REAL *motion;    /* (MR_MOTION, j padded) */
    MR_REAL *bodies;    /* (MR_BODY, b padded) */
    union {
        mr_wrench *real;
        mr_wrench_box *box;
    } wrench;           /* (j) */
    mr_pose *poses;     /* (j) */
    MR_REAL *axes;      /* (9, j padded) joint axes and points */
    MR_REAL *sines;     /* (2, j padded) */
    double *point;      /* (MR_POINT, b padded) */
    MR_REAL *lo, *hi, *mid, *slack; /* (j padded) results before they are known to be finite */
    MR_REAL *dq_a, *ddq_a, *dq_a_size, *ddq_a_size; /* (j padded) of (4) */
    MR_REAL *full[6];   /* (j padded) the state with its mimic joints */
} mr_workspace;

mr_workspace mr_workspace_view(const mr_model *model, double *memory);

/* Without a branch for each entry, because nearly always all are. */
static inline int mr_all_finite(int32_t n, const double *x) {
    int odd = 0;
    for (int32_t i = 0; i < n; ++i) odd |= !(fabs(x[i]) <= DBL_MAX);
    return !odd;
}

/* Copies the state and adds positions, velocities and accelerations of the mimic joints, (15);
 * without mimic joints only the positions are copied, which are read in registers. */
void mr_expand_mimic(const mr_model *model, mr_state *state, MR_REAL *const full[6]);

/* Checks the n entries of each vector and adds those of the mimic joints. */
mr_status mr_full_state(const mr_model *model, const mr_workspace *ws, const mr_state *given,
                        mr_state *state);

/* Adds the mimic joints' torques to those of their leaders, (15): from (j) to (n) in place. */
void mr_fold_mimic_torque(const mr_model *model, MR_REAL *tau);
void mr_fold_mimic_box(const mr_model *model, MR_REAL *lo, MR_REAL *hi);

void mr_sine_cosine(mr_lane x, mr_lane *sine, mr_lane *cosine);

/* Sines and cosines of all joints' positions. */
void mr_all_sines(const mr_model *model, const MR_REAL *q, MR_REAL *sines);

/* Rotation of link i to its parent and lever: A1:6 to A1:9 (lines of Algorithm 1). */
void mr_joint_geometry(const mr_model *model, int32_t i, const MR_REAL *q, const MR_REAL *sines,
                       mr_link *link);

/* A1:2 to A1:24 without the bodies. */
void mr_forward_recursion(const mr_model *model, const mr_state *state, const mr_workspace *ws);

/* Motion of every moving body in its own frame, and the force and moment that it asks for. */
void mr_body_pass(const mr_model *model, const double *point, const mr_workspace *ws);

/* From A1:25 on with real parameters, without drives. */
void mr_backward_recursion(const mr_model *model, const mr_workspace *ws, MR_REAL *tau);

/* All of NE* without drives; no checks. */
void mr_newton_euler(const mr_model *model, const double *point, const mr_state *state,
                     const mr_workspace *ws, MR_REAL *tau);

/* Sizes (25) of the motion that the forward recursion has left. */
mr_motion_size mr_size_of_motion(const mr_model *model, const mr_state *state,
                                 const mr_workspace *ws);

/* Constants of (26) for NE* at a parameter point; work holds mr_slack_work doubles. */
size_t mr_slack_work(const mr_model *model);
void mr_point_slack(const mr_model *model, const mr_parameters *parameters, double *work,
                    mr_slack_factors *factors, mr_slack_constants *constants);

/* What rounding may change in the torques; parameters are those of the drives, or NULL. */
void mr_rounding_slack(const mr_model *model, const mr_slack_factors *factors,
                       const mr_slack_constants *constants, const mr_parameters *parameters,
                       const mr_state *state, const mr_motion_size *size, MR_REAL *slack);

/* From A1:25 on, with intervals. */
void mr_ianea(const mr_model *model, const mr_bounds *bounds, const mr_motion_size *size,
              const mr_workspace *ws);

/* Range of the torque's difference from nominal over the box, (18), rounded to nearest. */
void mr_hull_deviation(const mr_model *model, const mr_bounds *bounds, const mr_workspace *ws);

/* (20) and (21): drive torque at a point, its box, and its box relative to nominal. */
void mr_add_drives(const mr_model *model, const mr_parameters *parameters, const mr_state *state,
                   MR_REAL *tau);
void mr_add_drives_box(const mr_model *model, const mr_bounds *bounds, const mr_state *state,
                       MR_REAL *lo, MR_REAL *hi);
void mr_add_drives_deviation(const mr_model *model, const mr_bounds *bounds, const mr_state *state,
                             MR_REAL *lo, MR_REAL *hi);

/* ws->mid: nominal torque; ws->lo, ws->hi: bounds of the torque (ianea), or of its difference from
 * nominal (hull), and ws->slack what rounding may add to either end of both. */
void mr_torque_box(const mr_model *model, const mr_bounds *bounds, mr_method method,
                   const mr_state *state, int drives, const mr_workspace *ws);

/* Bounds of the torque from what mr_torque_box leaves. */
void mr_total_bounds(const mr_model *model, mr_method method, const mr_workspace *ws);

/* (12): ws->mid is the nominal torque, ws->lo and ws->hi are [Phi]; all finite where the status is
 * MR_OK. */
mr_status mr_perturbation_box(const mr_model *model, const mr_bounds *bounds, mr_method method,
                              const mr_state *given, const mr_workspace *ws);

/* NE* and its rounding error (26) by constants of mr_point_slack. */
mr_status mr_torque_with_error(const mr_model *model, const mr_parameters *parameters,
                               const mr_slack_factors *factors,
                               const mr_slack_constants *constants, const mr_state *given,
                               int drives, double *workspace, double *tau, double *error);

/* Error e of (4) of a joint that wraps, and what its rounding is relative to: at most MR_U size. */
typedef struct {
    double e, size;
} mr_error;
mr_error mr_wrapped_error(double q_des, double q);

/* e of (4) of joint i. */
static inline double mr_error_of(const mr_model *model, int32_t i, const double *q_des,
                                 const double *q) {
    if (model->wraps && model->wraps[i]) return mr_wrapped_error(q_des[i], q[i]).e;
    return q_des[i] - q[i];
}

/* Whether the desired angle of a joint that wraps is beyond what can be reduced. */
int mr_beyond_wrapping(const mr_model *model, const double *q_des);

/* (8): the worst case of one joint, and an upper bound of the norm over all of them. */
static inline double mr_worst_case(double lo, double hi) {
    const double a = fabs(lo), b = fabs(hi);
    return a > b ? a : b;
}
double mr_worst_norm(int32_t n, const double *lo, const double *hi);

/* Auxiliary velocity and acceleration (n) of (4), and the sizes of their terms. */
mr_state mr_auxiliary(const mr_model *model, const mr_gains *gains, const double *q,
                      const double *dq, const double *q_des, const double *dq_des,
                      const double *ddq_des, double *const a[4]);

/* Memory of mr_command beyond that of the dynamics: a matrix, then arrays of n. */
enum {
    MR_ERROR,
    MR_RATE,
    MR_AHEAD_Q,
    MR_AHEAD_DQ,
    MR_AHEAD_DDQ,
    MR_NOMINAL,
    MR_FEEDBACK,
    MR_PULL,
    MR_ACCELERATION,
    MR_OFFSET,
    MR_OFFSET_RATE,
    MR_COMMAND_ARRAYS
};

/* What the law `sampled` remembers, arrays of n in mr_controller_state.memory. */
enum { MR_SIGMA, MR_PAST, MR_START, MR_START_RATE, MR_MEMORY };

/* 0, or MR_TIME where t is before the previous command; *elapsed is the time since then. */
mr_status mr_elapsed(const mr_controller_state *state, double t, double *elapsed);

/* The law `sampled`, (31) to (34). */
mr_status mr_sampled_command(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                             double t, const double *q, const double *dq, const double *q_des,
                             const double *dq_des, const double *ddq_des, double *workspace,
                             mr_controller_state *state, mr_command_out *out);

/* Its desired motion in the middle of the time that the command will be held for, the way from the
 * start included, after the first command. */
void mr_motion_ahead(const mr_model *model, const mr_gains *gains, double since_start,
                     const double *start, const double *start_rate, const double *q_des,
                     const double *dq_des, const double *ddq_des, double *q, double *dq,
                     double *ddq);

/* Where a law takes [Phi] and w: (4), or the motion ahead; a has room for four arrays. */
mr_state mr_state_of_law(const mr_model *model, const mr_gains *gains,
                         const mr_controller_state *state, double t, const double *q,
                         const double *dq, const double *q_des, const double *dq_des,
                         const double *ddq_des, double *const a[4]);

/* What is measured of q and dq where the loop's r is r. */
void mr_sense(int32_t n, mr_sensor *sensor, double dt, const double *r, const double *q,
              const double *dq, double *q_seen, double *dq_seen);

/* d at the beginning of a tick; of the worst kind its value where r is 0. */
void mr_draw_disturbance(const mr_bounds *bounds, int32_t n, mr_disturbance *disturbance, double t,
                         double *d);
void mr_push_away(const mr_bounds *bounds, int32_t n, const double *r, double *d);

/* Moves q and dq on by h under a constant torque: Runge-Kutta of fourth order, or, where friction is
 * too stiff for that, an implicit method of second order. */
size_t mr_plant_memory_size(const mr_model *model);
mr_status mr_explicit_step(const mr_model *model, const mr_parameters *parameters, double h,
                           const double *drive, double *workspace, double *memory, double *q,
                           double *dq);
mr_status mr_implicit_step(const mr_model *model, const mr_parameters *parameters, double h,
                           const double *drive, double *workspace, double *memory, double *q,
                           double *dq);

/* M(q) by composite bodies at the state that the last recursion left; M has room for (j, j). */
void mr_mass_here(const mr_model *model, const mr_parameters *parameters, double *workspace,
                  double *M);

/* Composite-body mass matrix (n, n) on links whose R and p are filled in; M has (j, j) room. */
void mr_composite_mass(const mr_model *model, const mr_parameters *parameters,
                       const mr_link *links, int drives, double *composite, double *M);

/* Solves M x = x in place for a symmetric positive definite M, which is overwritten. */
mr_status mr_cholesky_solve(int32_t n, double *M, double *x);

/* The public functions without the care for the floating-point environment: mr_entries.c. */
mr_status mr_do_inverse_dynamics(const mr_model *model, const mr_parameters *parameters,
                                 const double *q, const double *dq, const double *dq_a,
                                 const double *ddq_a, int drives, double *workspace, double *tau);
mr_status mr_do_inverse_dynamics_rounding(const mr_model *model, const mr_parameters *parameters,
                                          const double *q, const double *dq, const double *dq_a,
                                          const double *ddq_a, int drives, double *workspace,
                                          double *tau, double *error);
mr_status mr_do_inverse_dynamics_bounds(const mr_model *model, const mr_bounds *bounds,
                                        mr_method method, const double *q, const double *dq,
                                        const double *dq_a, const double *ddq_a, int drives,
                                        double *workspace, double *tau_lo, double *tau_hi);
mr_status mr_do_perturbation_bounds(const mr_model *model, const mr_bounds *bounds,
                                    mr_method method, const mr_state *given, double *workspace,
                                    double *nominal, double *phi_lo, double *phi_hi);
mr_status mr_do_bounds_slack(const mr_model *model, const mr_bounds *bounds, const double *q,
                             const double *dq, const double *dq_a, const double *ddq_a, int drives,
                             double *workspace, double *slack);
mr_status mr_do_mass_matrix(const mr_model *model, const mr_parameters *parameters,
                            const double *q, int drives, double *workspace, double *M);
mr_status mr_do_forward_dynamics(const mr_model *model, const mr_parameters *parameters,
                                 const double *q, const double *dq, const double *tau, int drives,
                                 double *workspace, double *ddq);
mr_status mr_do_forward_kinematics(const mr_model *model, const double *q, double *workspace,
                                   mr_transform *frames);
mr_status mr_do_tracking_error(const mr_model *model, const double *q, const double *q_des,
                               double *error);
mr_status mr_do_command(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                        double t, const double *q, const double *dq, const double *q_des,
                        const double *dq_des, const double *ddq_des, double *workspace,
                        mr_controller_state *state, mr_command_out *out);
mr_status mr_do_loop_advance(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                             const mr_parameters *true_parameters, int32_t count,
                             const double *q_des, const double *dq_des, const double *ddq_des,
                             int32_t log_every, double *workspace, mr_controller_state *state,
                             mr_loop *loop, mr_loop_log *log, int32_t *logged);
int32_t mr_do_find_uncertain(int32_t b, const mr_parameters *lower, const mr_parameters *upper,
                             int32_t *uncertain);
void mr_do_sincos(double x, double *sine, double *cosine);
void mr_do_precompute_model(const mr_model *model, double *precomputed);
void mr_do_prepare(const mr_model *model, const mr_bounds *bounds, double *prepared);

#endif
