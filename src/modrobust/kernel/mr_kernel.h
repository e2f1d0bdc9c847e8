/* Interval dynamics and robust control of rigid robots: the whole public interface.
 *
 * Equations by number: docs/theory/equations.md. SI units. Every function is free of heap, input
 * and output, globals and recursion; the caller owns all memory. Inputs are const, outputs come
 * last; on a status other than MR_OK the outputs and the controller's state are untouched, but for
 * mr_loop_advance, which keeps the ticks before, and the batch. Every function computes in round to
 * nearest with subnormal numbers, whatever the caller has set, and restores what it found. */
#ifndef MR_KERNEL_H
#define MR_KERNEL_H

#include <float.h>
#include <stddef.h>
#include <stdint.h>

/* Where a compiler says what it was allowed; mr_self_test sees the rest. */
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || \
    defined(__RECIPROCAL_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__NO_SIGNED_ZEROS__)
#error "modrobust: compile without -ffast-math and its parts (-ffinite-math-only, \
-freciprocal-math, -fassociative-math, -fno-signed-zeros); its guarantees rest on IEEE 754"
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    MR_OK = 0,
    MR_NOT_FINITE = 1,  /* an input or a result is infinite or not a number */
    MR_ANGLE_RANGE =
        2, /* an angle beyond MR_ANGLE_MAX: of a joint, or desired of one that wraps */
    MR_SINGULAR = 3,    /* the mass matrix is not positive definite */
    MR_TIME = 4,        /* time went backwards between two commands, by more than rounding */
    MR_DIVERGED = 5,    /* the closed loop left the range of the kernel */
    MR_PLATFORM = 6     /* this machine's arithmetic is not the one that the proof is about */
} mr_status;

typedef enum { MR_REVOLUTE = 0, MR_PRISMATIC = 1 } mr_joint_type;
typedef enum { MR_ABOUT_COM = 0, MR_ABOUT_FRAME = 1 } mr_inertia_point;
typedef enum { MR_HULL = 0, MR_IANEA = 1 } mr_method;
typedef enum { MR_LAW_NORM = 0, MR_LAW_COMPONENTWISE = 1, MR_LAW_SAMPLED = 2 } mr_law;

#define MR_ANGLE_MAX 1e5 /* [rad] */

/* Takes coordinates x in the child frame to R x + p in the parent frame; R row by row. */
typedef struct {
    double R[9];
    double p[3];
} mr_transform;

/* Geometry of a robot with b bodies and j joints, (14). parent[i] < i, -1 is the base. n joints
 * move freely; the j - n others mimic one of them, (15): every vector of positions, velocities,
 * accelerations and torques has n entries, every array of joint data has j. A revolute joint that
 * wraps may turn endlessly: its mimic joints shall then be revolute and their multipliers whole. */
typedef struct {
    int32_t n;
    int32_t j;
    int32_t b;
    const int32_t *joint_type;     /* (j) mr_joint_type */
    const int32_t *parent;         /* (j) */
    const mr_transform *before;    /* (j) parent link frame to joint frame */
    const mr_transform *after;     /* (j) joint frame to link frame, follows the motion */
    const double *gear_ratio;      /* (j) */
    const double *coulomb_speed;   /* (j) v_c of (20) [rad/s] or [m/s] */
    const int32_t *moves; /* (j) joint that entry i of a vector moves, ascending; then the
                                    * mimic joints; not read where all joints are free */
    const int32_t *leader; /* (j - n) entry of a vector that joint moves[n + k] mimics */
    const double *multiplier;      /* (j - n) */
    const double *offset;          /* (j - n) [rad] or [m] */
    const int32_t *body_joint;     /* (b) joint that moves the body, -1 is the base */
    const mr_transform *placement; /* (b) body frame in its link frame */
    const int32_t
        *inertia_about;  /* (b) mr_inertia_point: what all tensors of the body are about */
    double gravity[3];             /* in the base frame [m/s^2] */
    const double *precomputed;     /* what mr_precompute_model computed from all above */
    const int32_t *wraps;          /* (n) not 0: error of (4) less whole turns; NULL: nowhere */
} mr_model;

/* Computes the model's constants once, into mr_precomputed_size doubles; model->precomputed shall then
 * point to them. Every other function but those that return a size needs them. */
size_t mr_precomputed_size(const mr_model *model);
void mr_precompute_model(const mr_model *model, double *precomputed);

/* One point of the dynamic parameters. */
typedef struct {
    const double *mass;          /* (b) [kg] */
    const double *com;           /* (b, 3) in body axes [m] */
    const double *inertia;       /* (b, 6) xx xy xz yy yz zz, body axes [kg m^2] */
    const double *rotor_inertia; /* (j) motor side [kg m^2] */
    const double *viscous;       /* (j) joint side [N m s/rad] or [N s/m] */
    const double *coulomb;       /* (j) joint side [N m] or [N] */
} mr_parameters;

/* What the controller knows: a nominal point, its box, and the disturbance's box [d]. */
typedef struct {
    mr_parameters nominal;
    mr_parameters lower;
    mr_parameters upper;
    const double *disturbance_lo; /* (n) [N m] or [N] */
    const double *disturbance_hi; /* (n) */
    const int32_t *uncertain;     /* indices of bodies whose box is not a point, ascending */
    int32_t uncertain_count;
    const double *prepared;       /* what mr_prepare computed from all above */
} mr_bounds;

/* Computes the constants of a box once, into mr_prepared_size doubles; bounds->prepared shall then
 * point to them. With a model or a box that is not finite, lower > nominal > upper, or negative
 * mass, rotor inertia or friction, every function on these bounds returns MR_NOT_FINITE. */
size_t mr_prepared_size(const mr_model *model);
void mr_prepare(const mr_model *model, const mr_bounds *bounds, double *prepared);

/* Number of doubles in one packed parameter point, and its view: mass, com, inertia, rotor
 * inertia, viscous, coulomb, one after the other. */
size_t mr_parameters_size(const mr_model *model);
mr_parameters mr_parameters_view(const mr_model *model, const double *packed);

/* Lists the bodies whose box is not a point into uncertain (b); returns how many. */
int32_t mr_find_uncertain(int32_t b, const mr_parameters *lower, const mr_parameters *upper,
                          int32_t *uncertain);

/* Number of doubles of working memory that every function below needs. */
size_t mr_workspace_size(const mr_model *model);

/* NE*: M(q) ddq_a + C(q, dq) dq_a + g(q), with friction and reflected rotor inertia if drives. */
mr_status mr_inverse_dynamics(const mr_model *model, const mr_parameters *parameters,
                              const double *q, const double *dq, const double *dq_a,
                              const double *ddq_a, int drives, double *workspace, double *tau);

/* The same and a bound of its rounding error, (26), which also holds for the robot with exact
 * rotations and the constants as written. */
mr_status mr_inverse_dynamics_rounding(const mr_model *model, const mr_parameters *parameters,
                                       const double *q, const double *dq, const double *dq_a,
                                       const double *ddq_a, int drives, double *workspace,
                                       double *tau, double *error);

/* Bounds of NE* over the box of parameters, by the exact hull (17) or by Algorithm 1; rounding is
 * enclosed. */
mr_status mr_inverse_dynamics_bounds(const mr_model *model, const mr_bounds *bounds,
                                     mr_method method, const double *q, const double *dq,
                                     const double *dq_a, const double *ddq_a, int drives,
                                     double *workspace, double *tau_lo, double *tau_hi);

/* The same for `count` states, rows of (count, n) arrays, several side by side in a register; the
 * bits are those of the single call. On an error *row is a row that has it; rows before it may be
 * written. */
size_t mr_batch_workspace_size(const mr_model *model);
mr_status mr_inverse_dynamics_bounds_batch(const mr_model *model, const mr_bounds *bounds,
                                           mr_method method, int64_t count, const double *q,
                                           const double *dq, const double *dq_a,
                                           const double *ddq_a, int drives, double *workspace,
                                           double *tau_lo, double *tau_hi, int64_t *row);

/* What rounding may add to either end of the hull, (26): for reports. */
mr_status mr_bounds_slack(const mr_model *model, const mr_bounds *bounds, const double *q,
                          const double *dq, const double *dq_a, const double *ddq_a, int drives,
                          double *workspace, double *slack);

/* The perturbation set [Phi] of (12), drives and [d] included, and the nominal torque u0. */
mr_status mr_perturbation_bounds(const mr_model *model, const mr_bounds *bounds, mr_method method,
                                 const double *q, const double *dq, const double *dq_a,
                                 const double *ddq_a, double *workspace, double *nominal,
                                 double *phi_lo, double *phi_hi);

/* The same for the two functions of the plant below, mr_workspace_size included. */
size_t mr_dynamics_workspace_size(const mr_model *model);

/* Joint-space mass matrix (n, n), with reflected rotor inertia on the diagonal if drives. */
mr_status mr_mass_matrix(const mr_model *model, const mr_parameters *parameters, const double *q,
                         int drives, double *workspace, double *M);

/* Acceleration of the plant (23) under the torque tau. */
mr_status mr_forward_dynamics(const mr_model *model, const mr_parameters *parameters,
                              const double *q, const double *dq, const double *tau, int drives,
                              double *workspace, double *ddq);

/* Link frames in the base frame (j). */
mr_status mr_forward_kinematics(const mr_model *model, const double *q, double *workspace,
                                mr_transform *frames);

/* The control laws: (3), (4), (7), (8), (29) and (31) to (34). What only one of them reads may be
 * zero or NULL for the others. */
typedef struct {
    const double *K_r; /* (n) diagonal [1/s], of norm and componentwise, as the next two lines */
    double kappa_P, kappa_I, phi_P, phi_I;
    double kappa_max, phi_max; /* ceilings of kappa and phi; 0: none */
    double leak;               /* decay of their integral [1/s] */
    double epsilon;            /* radius within which the integrators rest */
    mr_law law;
    mr_method method;
    int32_t hold_aware;   /* of norm and componentwise: the command is held, (29) */
    double period;        /* T, for which a command is held [s] */
    double delay;         /* D, how late it acts, in periods, 0 to 1 */
    double G, Lambda;     /* of sampled [1/s], as all that follows but light */
    double L_i;           /* [1/s^2] */
    double blend;         /* time from the state at the start to the motion [s] */
    int32_t integral;     /* parts of the law that can be left out */
    int32_t predictor;
    int32_t vector_saturation;
    const double *effort_limit; /* (n) [N m] or [N], may be infinite */
    mr_parameters centre; /* D_c of (30) */
    mr_parameters light;  /* D_s of (30), of hold_aware too */
} mr_gains;

typedef struct {
    double integral;       /* of f(|e|) over time, e of (4) */
    double previous_f;     /* f at the previous command */
    double previous_time;  /* [s] */
    int32_t started; /* 0 before the first command; -1: that one starts from a q in memory */
    double start_time; /* of the first command [s] */
    double *memory; /* (mr_controller_memory_size) of sampled; NULL for the others */
} mr_controller_state;

/* Number of doubles that the law `sampled` remembers: sigma of (33), the acceleration of (31), and
 * where it started from, (34), its position and velocity, n each. Before the first command they do
 * not matter, but for the position where state->started is -1: it starts from there, and else from
 * where it is measured. */
size_t mr_controller_memory_size(const mr_model *model);

/* The error e of (4) (n): q_des - q, of a joint that wraps less the whole turns that leave at most
 * half a one. */
mr_status mr_tracking_error(const mr_model *model, const double *q, const double *q_des,
                            double *error);

/* Arrays of n doubles that the caller provides. */
typedef struct {
    double *tau; /* the command: nominal + v, cut at the limits by vector_saturation */
    double *nominal; /* u0 */
    double *v;
    double *phi_lo;
    double *phi_hi;
    double *rho; /* (8) */
    double rho_norm;
    double kappa;
    double phi;
    double alpha; /* share of the feedback that the limits leave room for, (32); else 1 */
} mr_command_out;

/* Number of doubles of working memory of mr_command, mr_workspace_size included. */
size_t mr_command_workspace_size(const mr_model *model);

mr_status mr_command(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                     double t, const double *q, const double *dq, const double *q_des,
                     const double *dq_des, const double *ddq_des, double *workspace,
                     mr_controller_state *state, mr_command_out *out);

/* Number of doubles of working memory of mr_loop_advance, mr_workspace_size included. */
size_t mr_loop_workspace_size(const mr_model *model);

/* How q and dq are measured, (28): with errors in a box, then in steps. */
typedef struct {
    const double *noise_q, *noise_dq; /* (n) half widths of the box, or NULL */
    const double *step_q, *step_dq; /* (n) or NULL; 0 = none */
    int32_t worst; /* errors at the end of the box that hides r, instead of drawn ones */
    double filter; /* dq is differentiated from q, and this share of it taken; 0: measured */
    uint64_t random[2]; /* state of the generator, not both 0 */
    int32_t started;
    double *previous_q, *rate; /* (n) of a differentiated velocity */
} mr_sensor;

typedef enum { MR_CONSTANT = 0, MR_SINE = 1, MR_RANDOM = 2, MR_WORST = 3 } mr_disturbance_kind;

/* d within [d]: as given, a sine over the whole box, drawn at each tick, or at each step the end of
 * the box that pushes along -r. */
typedef struct {
    mr_disturbance_kind kind;
    const double *constant; /* (n) */
    double frequency; /* of a sine [Hz] */
    uint64_t random[2]; /* state of the generator, not both 0 */
} mr_disturbance;

/* A robot that is not ours: moves q and dq on by h under the torque (drives and disturbance). */
typedef mr_status (*mr_plant)(void *context, double h, const double *drive, double *q, double *dq);

/* The closed loop of controller and plant (23); the command is held for one tick. */
typedef struct {
    double dt; /* tick [s] */
    int32_t substeps; /* steps of the integrator a tick */
    int32_t implicit; /* an implicit step instead of Runge-Kutta's, for stiff friction */
    double delay; /* ticks after which a command acts, 0 to 1 */
    int32_t saturation; /* the drive cuts commands at the limits of mr_gains.effort_limit */
    mr_sensor sensor;
    mr_disturbance disturbance;
    mr_plant plant; /* NULL: our own */
    void *context; /* of the plant */
    int64_t ticks; /* ticks done; time = ticks * dt */
    int64_t violations; /* ticks at which w left [Phi], (24) */
    double violation_max;
    double error_last; /* |e| of (4) at the last tick */
    double last_outside; /* last time with error >= epsilon, -1 if never [s] */
    double error_max_after; /* largest error since then */
    double rho_sum, rho_max;
    int64_t limited; /* ticks at which a limit changed a command */
    double *q, *dq; /* (n) state of the plant */
    double *tau_previous; /* (n) */
    double *tau_max; /* (n) largest |tau| */
    double *total_variation; /* (n) sum of |tau_k - tau_(k-1)| over all ticks */
    double *ticks_at_limit; /* (n) ticks at which that joint's torque was cut, or at its limit */
} mr_loop;

/* One logged tick: pointers to n doubles each. */
typedef struct {
    double *t; /* one double */
    double *q, *dq, *q_des, *dq_des, *ddq_des, *tau, *nominal, *w, *phi_lo, *phi_hi, *rho;
    double *width_hull, *width_ianea, *total_variation;
} mr_loop_log;

/* Runs `count` ticks on the reference rows (count, n); logs every tick whose number is a multiple
 * of log_every into rows log_start, log_start + 1, ... of the log arrays and returns in *logged
 * how many. Stops with MR_DIVERGED at the tick that cannot be computed; all before it stands. */
mr_status mr_loop_advance(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                          const mr_parameters *true_parameters, int32_t count, const double *q_des,
                          const double *dq_des, const double *ddq_des, int32_t log_every,
                          double *workspace, mr_controller_state *state, mr_loop *loop,
                          mr_loop_log *log, int32_t *logged);

/* MR_PLATFORM where the machine or the build does not round as the proof in
 * docs/theory/rounding.md needs it; to be called once, before anything else. */
mr_status mr_self_test(void);

/* Sine and cosine for |x| <= MR_ANGLE_MAX; the same bits on every platform. */
void mr_sincos(double x, double *sine, double *cosine);

#ifdef __cplusplus
}
#endif
#endif
