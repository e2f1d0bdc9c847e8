/* One command of the robust controller in C: no Python, no heap, no files.
 *
 * A two-joint arm in a vertical plane: both axes are horizontal (z), each link is 0.35 m long. The
 * second link's mass and centre of mass are uncertain; the rest is exact. */
#include <stdio.h>

#include "mr_kernel.h"

enum { N = 2, BODIES = 2, MEMORY = 4096 };

/* The robot: T_i = before_i Rz(q_i) after_i. */
#define TURN_NONE {1, 0, 0, 0, 1, 0, 0, 0, 1}
static const int32_t joint_type[N] = {MR_REVOLUTE, MR_REVOLUTE};
static const int32_t parent[N] = {-1, 0};
static const mr_transform before[N] = {{TURN_NONE, {0, 0, 0}}, {TURN_NONE, {0, 0, 0}}};
static const mr_transform after[N] = {{TURN_NONE, {0.35, 0, 0}}, {TURN_NONE, {0.35, 0, 0}}};
static const double gear_ratio[N] = {100, 100}, coulomb_speed[N] = {1e-3, 1e-3};
static const int32_t moves[N] = {0, 1}; /* entry i of every vector moves joint i */
static const int32_t body_joint[BODIES] = {0, 1};
static const int32_t inertia_about[BODIES] = {MR_ABOUT_COM, MR_ABOUT_COM};
static const mr_transform placement[BODIES] = {{TURN_NONE, {-0.35, 0, 0}},
                                               {TURN_NONE, {-0.35, 0, 0}}};

/* What is known of it: xx xy xz yy yz zz of each tensor, about the centre of mass. */
static const double inertia[BODIES * 6] = {0.002, 0, 0, 0.02, 0, 0.02, 0.001, 0, 0, 0.01, 0, 0.01};
static const double rotor_inertia[N] = {3e-5, 2e-5}; /* [kg m^2] */
static const double viscous[N] = {2, 1};             /* [N m s/rad] */
static const double coulomb[N] = {0, 0};             /* [N m] */
static const double mass[3][BODIES] = {{3, 1.5}, {3, 1.0}, {3, 2.0}}; /* nominal, lo, hi [kg] */
static const double com[3][BODIES * 3] = {
    {0.17, 0, 0, 0.20, 0, 0}, {0.17, 0, 0, 0.15, 0, 0}, {0.17, 0, 0, 0.25, 0, 0}}; /* [m] */

static mr_parameters point(int k) {
    const mr_parameters p = {.mass = mass[k],
                             .com = com[k],
                             .inertia = inertia,
                             .rotor_inertia = rotor_inertia,
                             .viscous = viscous,
                             .coulomb = coulomb};
    return p;
}

static double precomputed[MEMORY], prepared[MEMORY], workspace[MEMORY];

int main(void) {
    if (mr_self_test() != MR_OK) return 1; /* once, before anything else */

    mr_model model = {.n = N,
                      .j = N, /* no joint mimics another */
                      .b = BODIES,
                      .joint_type = joint_type,
                      .parent = parent,
                      .before = before,
                      .after = after,
                      .gear_ratio = gear_ratio,
                      .coulomb_speed = coulomb_speed,
                      .moves = moves,
                      .body_joint = body_joint,
                      .placement = placement,
                      .inertia_about = inertia_about,
                      .gravity = {0, -9.81, 0}};
    if (mr_precomputed_size(&model) > MEMORY || mr_command_workspace_size(&model) > MEMORY)
        return 1;
    mr_precompute_model(&model, precomputed);
    model.precomputed = precomputed;

    const double d[N] = {0.2, 0.2}, minus_d[N] = {-0.2, -0.2}; /* [d] [N m] */
    int32_t uncertain[BODIES];
    mr_bounds bounds = {.nominal = point(0),
                        .lower = point(1),
                        .upper = point(2),
                        .disturbance_lo = minus_d,
                        .disturbance_hi = d,
                        .uncertain = uncertain};
    bounds.uncertain_count = mr_find_uncertain(BODIES, &bounds.lower, &bounds.upper, uncertain);
    if (mr_prepared_size(&model) > MEMORY) return 1;
    mr_prepare(&model, &bounds, prepared);
    bounds.prepared = prepared;

    const double K_r[N] = {10, 10};
    const mr_gains gains = {.K_r = K_r,
                            .kappa_P = 0.1,
                            .kappa_I = 1,
                            .phi_P = 40,
                            .phi_I = 100,
                            .epsilon = 0.01,
                            .law = MR_LAW_NORM,
                            .method = MR_HULL};
    mr_controller_state state = {0};
    double tau[N], nominal[N], v[N], phi_lo[N], phi_hi[N], rho[N];
    mr_command_out out = {.tau = tau, .nominal = nominal, .v = v,
                          .phi_lo = phi_lo, .phi_hi = phi_hi, .rho = rho};

    /* In your loop: read q and dq, ask for the command, send tau. Here two ticks of 1 ms. */
    const double q[N] = {0.3, -0.6}, dq[N] = {0, 0}, q_des[N] = {0.31, -0.6}, rest[N] = {0, 0};
    for (int tick = 0; tick < 2; ++tick) {
        const mr_status status = mr_command(&model, &bounds, &gains, 1e-3 * tick, q, dq, q_des,
                                            rest, rest, workspace, &state, &out);
        if (status != MR_OK) { /* no command: stop the machine safely */
            fprintf(stderr, "status %d\n", (int)status);
            return 1;
        }
        for (int i = 0; i < N; ++i)
            printf("t = %.3f s, joint %d: tau %.6f = %.6f + %.6f, [Phi] = [%.6f, %.6f] N m\n",
                   1e-3 * tick, i + 1, tau[i], nominal[i], v[i], phi_lo[i], phi_hi[i]);
    }
    return 0;
}
