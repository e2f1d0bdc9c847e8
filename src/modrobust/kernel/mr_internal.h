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

/* Constants of a model, (j) of the first and (b) of the second after the header, all doubles. */
typedef struct {
    double depth;     /* joints on the longest way from the base to a link */
    double defect;    /* sum of all rotation matrices' distances from an orthonormal one */
    double serial;    /* 1 where every joint's parent is the joint before it */
    double prismatic; /* 1 where a joint is prismatic */
} mr_model_constants;

typedef struct {
    double before;       /* how the transform before the joint acts */
    double lever[3];     /* joint frame's origin to link frame's, in link axes, at q = 0 */
    double before_norm;  /* |p| of the transform before */
    double lever_norm;
} mr_joint_constants;

typedef struct {
    double placement; /* how it acts */
    double lever_norm;
} mr_body_constants;

static inline const mr_model_constants *mr_of_model(const mr_model *model) {
    return (const mr_model_constants *)model->folded;
}

static inline const mr_joint_constants *mr_of_joints(const mr_model *model) {
    return (const mr_joint_constants *)(mr_of_model(model) + 1);
}

static inline const mr_body_constants *mr_of_bodies(const mr_model *model) {
    return (const mr_body_constants *)(mr_of_joints(model) + model->j);
}

/* Sizes of one body's parameters, for the rounding bound. */
typedef struct {
    double mass, com, inertia; /* mass, |c|, Frobenius norm of I */
} mr_body_norms;

mr_body_norms mr_norms_of(const mr_parameters *parameters, int32_t b);

/* An uncertain body's box as differences from nominal: shift +- radius. */
typedef struct {
    double off_centre;    /* 0 where every shift is zero */
    double com_shift[3], com_radius[3];
    double mass_shift, mass_radius, mass_middle;
    double inertia_shift[6], inertia_radius[6];
    double com_norm, mass_change, inertia_norm, mass_largest; /* sizes of the changes */
} mr_body_box;

/* In mr_bounds.prepared: norms at nominal and at the largest point of each body (b each), then the
 * boxes of the uncertain bodies. */
static inline const mr_body_norms *mr_nominal_norms(const mr_bounds *bounds) {
    return (const mr_body_norms *)bounds->prepared;
}

static inline const mr_body_norms *mr_largest_norms(const mr_model *model,
                                                    const mr_bounds *bounds) {
    return mr_nominal_norms(bounds) + model->b;
}

static inline const mr_body_box *mr_boxes(const mr_model *model, const mr_bounds *bounds) {
    return (const mr_body_box *)(mr_nominal_norms(bounds) + 2 * model->b);
}

/* State of one link after the forward recursion of Algorithm 1, all in the link's own frame. */
typedef struct {
    MR_REAL R[9];  /* link to parent link, line 6 */
    MR_REAL p[3];  /* joint frame origin to link frame origin, line 9 */
    MR_REAL w[3];  /* angular velocity, lines 13 and 18 */
    MR_REAL wa[3]; /* auxiliary angular velocity, lines 14 and 19 */
    MR_REAL dw[3]; /* angular acceleration, lines 15 and 20 */
    MR_REAL a[3];  /* acceleration of the link frame origin minus gravity, lines 16 and 21 */
} mr_link;

/* The same for one body, in the body's frame. */
typedef struct {
    MR_REAL w[3], wa[3], dw[3], a[3];
    MR_REAL L[9]; /* (16) */
} mr_motion;

typedef struct {
    MR_REAL f[3], n[3];
} mr_wrench;

typedef struct {
    mr_interval f[3], n[3];
} mr_wrench_box;

/* Upper bounds of Euclidean norms, link by link, (25). */
typedef struct {
    MR_REAL w, wa, dw, a; /* as in mr_link */
    MR_REAL K;            /* of L in (16) */
    MR_REAL p;            /* of the lever between joint and link frame */
    MR_REAL reach;        /* of the way from the base to the link frame */
    MR_REAL follower;     /* error of a follower's angle, in units of u */
    MR_REAL f, n;         /* force and moment about the joint frame, nominal */
    MR_REAL df, dn;       /* their changes over the box */
} mr_size;

/* Joint and link seen from the base frame, for the hull. */
typedef struct {
    MR_REAL R[9];      /* link to base */
    MR_REAL origin[3]; /* of the link frame */
} mr_pose;

/* What a function is asked about, (j) each. */
typedef struct {
    const MR_REAL *q, *dq, *dq_a, *ddq_a;
} mr_state;

/* The caller's working memory, cut into arrays. */
typedef struct {
    mr_link *links;     /* (j) */
    mr_motion *motions; /* (b) */
    union {
        mr_wrench *real;
        mr_wrench_box *box;
    } wrench;           /* (j) */
    mr_size *sizes;     /* (j) */
    mr_pose *poses;     /* (j) */
    MR_REAL *axes;      /* (9, j padded) joint axes and points, component by component */
    MR_REAL *lo, *hi, *mid, *slack; /* (j) results before they are known to be finite */
    MR_REAL *dq_a, *ddq_a; /* (j) */
    MR_REAL *full[4];   /* (j) a state with its followers */
} mr_workspace;

/* Joints, padded so that a register can be read at any of them. */
static inline size_t mr_padded(const mr_model *model) { return (size_t)model->j + 8; }

mr_workspace mr_workspace_view(const mr_model *model, double *memory);

/* NaN or infinite where an entry of x is: finite otherwise. */
static inline int mr_all_finite(int32_t n, const double *x) {
    for (int32_t i = 0; i < n; ++i)
        if (!isfinite(x[i])) return 0;
    return 1;
}

/* Adds the positions, velocities and accelerations of the followers, (15). */
void mr_follow(const mr_model *model, mr_state *state, MR_REAL *const full[4]);

/* Checks the n entries of each vector and adds those of the followers. */
mr_status mr_full_state(const mr_model *model, const mr_workspace *ws, const double *q,
                        const double *dq, const double *dq_a, const double *ddq_a,
                        mr_state *state);

/* Adds the followers' torques to those of their leaders, (15). */
void mr_lead(const mr_model *model, MR_REAL *tau);
void mr_lead_box(const mr_model *model, MR_REAL *lo, MR_REAL *hi);

void mr_sine_cosine(MR_REAL x, MR_REAL *sine, MR_REAL *cosine);

/* Rotation of link i to its parent and lever: lines 6 to 9 of Algorithm 1. */
void mr_joint_geometry(const mr_model *model, int32_t i, MR_REAL q, mr_link *link);

/* Lines 2 to 24 of Algorithm 1 without the bodies. */
void mr_forward_recursion(const mr_model *model, const mr_state *state, mr_link *links);

/* Motion of every moving body, in its own frame. */
void mr_body_motions(const mr_model *model, const mr_link *links, mr_motion *motions);

/* NE* on links and motions that are filled in, without drives; no checks. */
void mr_newton_euler(const mr_model *model, const mr_parameters *parameters, const mr_link *links,
                     const mr_motion *motions, mr_wrench *wrenches, MR_REAL *tau);

/* Sizes of the motion, (25); returns the sum of what the followers' angles are off, in u. */
MR_REAL mr_motion_sizes(const mr_model *model, const mr_state *state, mr_size *sizes);

/* What rounding may change in NE* at a parameter point, and in NE* at nominal and the hull's
 * deviation together, (26), after mr_motion_sizes. */
void mr_nominal_slack(const mr_model *model, const mr_parameters *parameters,
                      const mr_state *state, MR_REAL followed, int drives, mr_size *sizes,
                      MR_REAL *slack);
void mr_hull_slack(const mr_model *model, const mr_bounds *bounds, const mr_state *state,
                   MR_REAL followed, int drives, mr_size *sizes, MR_REAL *slack);

/* Algorithm 1 from line 25 on. */
void mr_ianea(const mr_model *model, const mr_bounds *bounds, const mr_link *links,
              const mr_motion *motions, const mr_size *sizes, MR_REAL followed,
              mr_wrench_box *wrenches, MR_REAL *tau_lo, MR_REAL *tau_hi);

/* Range of the torque's difference from nominal over the box, (18), rounded to nearest. */
void mr_hull_deviation(const mr_model *model, const mr_bounds *bounds, const mr_link *links,
                       const mr_motion *motions, mr_pose *poses, MR_REAL *axes, MR_REAL *lo,
                       MR_REAL *hi);

/* (20) and (21): drive torque at a point, its box, and its box relative to nominal. */
MR_REAL mr_smooth_sign(MR_REAL dq, double coulomb_speed);
void mr_add_drives(const mr_model *model, const mr_parameters *parameters, const MR_REAL *dq,
                   const MR_REAL *ddq_a, MR_REAL *tau);
void mr_add_drives_box(const mr_model *model, const mr_bounds *bounds, const MR_REAL *dq,
                       const MR_REAL *ddq_a, MR_REAL *lo, MR_REAL *hi);
void mr_add_drives_deviation(const mr_model *model, const mr_bounds *bounds, const MR_REAL *dq,
                             const MR_REAL *ddq_a, MR_REAL *lo, MR_REAL *hi);

/* ws->mid: nominal torque; ws->lo, ws->hi: bounds of the torque (ianea), or of its difference from
 * nominal (hull), and ws->slack what rounding may add to either end of both. */
void mr_torque_box(const mr_model *model, const mr_bounds *bounds, mr_method method,
                   const mr_state *state, int drives, mr_workspace *ws);

/* Bounds of the torque from what mr_torque_box leaves. */
void mr_total_bounds(const mr_model *model, mr_method method, mr_workspace *ws);

/* Auxiliary velocity and acceleration (n) of (4). */
void mr_auxiliary(int32_t n, const mr_gains *gains, const double *q, const double *dq,
                  const double *q_des, const double *dq_des, const double *ddq_des, double *dq_a,
                  double *ddq_a);

/* Composite-body mass matrix (n, n) on links whose R and p are filled in; M has (j, j) room. */
void mr_composite_mass(const mr_model *model, const mr_parameters *parameters,
                       const mr_link *links, int drives, double *composite, double *M);

/* Solves M x = x in place for a symmetric positive definite M, which is overwritten. */
mr_status mr_cholesky_solve(int32_t n, double *M, double *x);

/* The public functions without the care for the floating-point environment: mr_entries.c. */
mr_status mr_do_inverse_dynamics(const mr_model *model, const mr_parameters *parameters,
                                 const double *q, const double *dq, const double *dq_a,
                                 const double *ddq_a, int drives, double *workspace, double *tau,
                                 double *error);
mr_status mr_do_inverse_dynamics_bounds(const mr_model *model, const mr_bounds *bounds,
                                        mr_method method, const double *q, const double *dq,
                                        const double *dq_a, const double *ddq_a, int drives,
                                        double *workspace, double *tau_lo, double *tau_hi);
mr_status mr_do_perturbation_bounds(const mr_model *model, const mr_bounds *bounds,
                                    mr_method method, const double *q, const double *dq,
                                    const double *dq_a, const double *ddq_a, double *workspace,
                                    double *nominal, double *phi_lo, double *phi_hi);
mr_status mr_do_bounds_slack(const mr_model *model, const mr_bounds *bounds, const double *q,
                             const double *dq, const double *dq_a, const double *ddq_a,
                             int drives, double *workspace, double *slack);
mr_status mr_do_mass_matrix(const mr_model *model, const mr_parameters *parameters,
                            const double *q, int drives, double *workspace, double *M);
mr_status mr_do_forward_dynamics(const mr_model *model, const mr_parameters *parameters,
                                 const double *q, const double *dq, const double *tau, int drives,
                                 double *workspace, double *ddq);
mr_status mr_do_forward_kinematics(const mr_model *model, const double *q, double *workspace,
                                   mr_transform *frames);
mr_status mr_do_command(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                        double t, const double *q, const double *dq, const double *q_des,
                        const double *dq_des, const double *ddq_des, double *workspace,
                        mr_controller_state *state, mr_command_out *out);
mr_status mr_do_loop_advance(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                             const mr_parameters *true_parameters, const double *true_disturbance,
                             int32_t count, const double *q_des, const double *dq_des,
                             const double *ddq_des, int32_t log_every, double *workspace,
                             mr_controller_state *state, mr_loop *loop, mr_loop_log *log,
                             int32_t *logged);
int32_t mr_do_find_uncertain(int32_t b, const mr_parameters *lower, const mr_parameters *upper,
                             int32_t *uncertain);
void mr_do_fold(const mr_model *model, double *folded);
void mr_do_prepare(const mr_model *model, const mr_bounds *bounds, double *prepared);

#endif
