/* What the kernel's files share and nobody else sees. */
#ifndef MR_INTERNAL_H
#define MR_INTERNAL_H

#include "mr_kernel.h"
#include "mr_vector.h"

/* State of one link after the forward recursion of Algorithm 1, all in the link's own frame. */
typedef struct {
    double R[9];  /* link to parent link, line 6 */
    double z[3];  /* joint axis, line 8 */
    double p[3];  /* joint frame origin to link frame origin, line 9 */
    double w[3];  /* angular velocity, lines 13 and 18 */
    double wa[3]; /* auxiliary angular velocity, lines 14 and 19 */
    double dw[3]; /* angular acceleration, lines 15 and 20 */
    double a[3];  /* acceleration of the link frame origin minus gravity, lines 16 and 21 */
} mr_link;

/* The same for one body, in the body's frame. */
typedef struct {
    double w[3], wa[3], dw[3], a[3];
} mr_motion;

typedef struct {
    double f[3], n[3];
} mr_wrench;

typedef struct {
    mr_interval f[3], n[3];
} mr_wrench_box;

/* Joint and link seen from the base frame, for the hull. */
typedef struct {
    double R[9];      /* link to base */
    double origin[3]; /* of the link frame */
    double axis[3];   /* of the joint */
    double point[3];  /* on the joint's axis: its frame's origin */
} mr_pose;

/* What a function is asked about, (j) each. */
typedef struct {
    const double *q, *dq, *dq_a, *ddq_a;
} mr_state;

/* The caller's working memory, cut into arrays of j. */
typedef struct {
    mr_link *links;
    union {
        mr_wrench *real;
        mr_wrench_box *box;
    } wrench;
    mr_pose *poses;
    double *lo, *hi, *mid; /* results before they are known to be finite */
    double *dq_a, *ddq_a;
    double *full[4]; /* a state with its followers */
} mr_workspace;

mr_workspace mr_workspace_view(const mr_model *model, double *memory);

mr_status mr_check_vector(int32_t n, const double *x);

/* Checks the n entries of each vector and adds those of the followers, (15). */
mr_status mr_full_state(const mr_model *model, const mr_workspace *ws, const double *q,
                        const double *dq, const double *dq_a, const double *ddq_a,
                        mr_state *state);

/* Adds the followers' torques to those of their leaders, (15). */
void mr_lead(const mr_model *model, double *tau);
void mr_lead_box(const mr_model *model, double *lo, double *hi);

/* Rotation of link i to its parent, joint axis and lever: lines 6 to 9 of Algorithm 1. */
void mr_joint_geometry(const mr_model *model, int32_t i, double q, mr_link *link);

/* Lines 2 to 24 of Algorithm 1 without the bodies. */
void mr_forward_recursion(const mr_model *model, const mr_state *state, mr_link *links);

/* Motion of body k, in its own frame. */
void mr_body_motion(const mr_model *model, const mr_link *links, int32_t k, mr_motion *motion);

/* NE* on links that are filled in, without drives; no checks. */
void mr_newton_euler(const mr_model *model, const mr_parameters *parameters, const mr_link *links,
                     mr_wrench *wrenches, double *tau);

/* Algorithm 1 from line 25 on. */
void mr_ianea(const mr_model *model, const mr_parameters *lower, const mr_parameters *upper,
              const mr_link *links, mr_wrench_box *wrenches, double *tau_lo, double *tau_hi);

/* Range of the torque's difference from nominal over the box, (18). */
void mr_hull_deviation(const mr_model *model, const mr_bounds *bounds, const mr_link *links,
                       mr_pose *poses, double *lo, double *hi);

/* (20) and (21): drive torque at a point, its box, and its box relative to nominal. */
double mr_smooth_sign(double dq, double coulomb_speed);
void mr_add_drives(const mr_model *model, const mr_parameters *parameters, const double *dq,
                   const double *ddq_a, double *tau);
void mr_add_drives_box(const mr_model *model, const mr_bounds *bounds, const double *dq,
                       const double *ddq_a, double *lo, double *hi);
void mr_add_drives_deviation(const mr_model *model, const mr_bounds *bounds, const double *dq,
                             const double *ddq_a, double *lo, double *hi);

/* Auxiliary velocity and acceleration (n) of (4). */
void mr_auxiliary(int32_t n, const mr_gains *gains, const double *q, const double *dq,
                  const double *q_des, const double *dq_des, const double *ddq_des, double *dq_a,
                  double *ddq_a);

/* Composite-body mass matrix (n, n) on links whose R, z and p are filled in; M has (j, j) room. */
void mr_composite_mass(const mr_model *model, const mr_parameters *parameters,
                       const mr_link *links, int drives, double *composite, double *M);

/* Solves M x = x in place for a symmetric positive definite M, which is overwritten. */
mr_status mr_cholesky_solve(int32_t n, double *M, double *x);

#endif
