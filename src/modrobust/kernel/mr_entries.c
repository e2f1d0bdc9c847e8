/* The public functions: each owns the floating-point environment while it works. No arithmetic. */
#include "mr_environment.h"
#include "mr_internal.h"

#define IN_OUR_ENVIRONMENT(call)                   \
    const mr_environment caller = mr_enter();      \
    const mr_status status = call;                 \
    mr_leave(caller);                              \
    return status

void mr_precompute_model(const mr_model *model, double *precomputed) {
    const mr_environment caller = mr_enter();
    mr_do_precompute_model(model, precomputed);
    mr_leave(caller);
}

void mr_prepare(const mr_model *model, const mr_bounds *bounds, double *prepared) {
    const mr_environment caller = mr_enter();
    mr_do_prepare(model, bounds, prepared);
    mr_leave(caller);
}

int32_t mr_find_uncertain(int32_t b, const mr_parameters *lower, const mr_parameters *upper,
                          int32_t *uncertain) {
    const mr_environment caller = mr_enter();
    const int32_t count = mr_do_find_uncertain(b, lower, upper, uncertain);
    mr_leave(caller);
    return count;
}

mr_status mr_inverse_dynamics(const mr_model *model, const mr_parameters *parameters,
                              const double *q, const double *dq, const double *dq_a,
                              const double *ddq_a, int drives, double *workspace, double *tau) {
    IN_OUR_ENVIRONMENT(
        mr_do_inverse_dynamics(model, parameters, q, dq, dq_a, ddq_a, drives, workspace, tau));
}

mr_status mr_inverse_dynamics_rounding(const mr_model *model, const mr_parameters *parameters,
                                       const double *q, const double *dq, const double *dq_a,
                                       const double *ddq_a, int drives, double *workspace,
                                       double *tau, double *error) {
    IN_OUR_ENVIRONMENT(mr_do_inverse_dynamics_rounding(model, parameters, q, dq, dq_a, ddq_a,
                                                       drives, workspace, tau, error));
}

mr_status mr_inverse_dynamics_bounds(const mr_model *model, const mr_bounds *bounds,
                                     mr_method method, const double *q, const double *dq,
                                     const double *dq_a, const double *ddq_a, int drives,
                                     double *workspace, double *tau_lo, double *tau_hi) {
    IN_OUR_ENVIRONMENT(mr_do_inverse_dynamics_bounds(model, bounds, method, q, dq, dq_a, ddq_a,
                                                     drives, workspace, tau_lo, tau_hi));
}

mr_status mr_perturbation_bounds(const mr_model *model, const mr_bounds *bounds, mr_method method,
                                 const double *q, const double *dq, const double *dq_a,
                                 const double *ddq_a, double *workspace, double *nominal,
                                 double *phi_lo, double *phi_hi) {
    const mr_state given = {q, dq, dq_a, ddq_a, NULL, NULL};
    IN_OUR_ENVIRONMENT(mr_do_perturbation_bounds(model, bounds, method, &given, workspace, nominal,
                                                 phi_lo, phi_hi));
}

mr_status mr_bounds_slack(const mr_model *model, const mr_bounds *bounds, const double *q,
                          const double *dq, const double *dq_a, const double *ddq_a, int drives,
                          double *workspace, double *slack) {
    IN_OUR_ENVIRONMENT(
        mr_do_bounds_slack(model, bounds, q, dq, dq_a, ddq_a, drives, workspace, slack));
}

mr_status mr_mass_matrix(const mr_model *model, const mr_parameters *parameters, const double *q,
                         int drives, double *workspace, double *M) {
    IN_OUR_ENVIRONMENT(mr_do_mass_matrix(model, parameters, q, drives, workspace, M));
}

mr_status mr_forward_dynamics(const mr_model *model, const mr_parameters *parameters,
                              const double *q, const double *dq, const double *tau, int drives,
                              double *workspace, double *ddq) {
    IN_OUR_ENVIRONMENT(
        mr_do_forward_dynamics(model, parameters, q, dq, tau, drives, workspace, ddq));
}

mr_status mr_forward_kinematics(const mr_model *model, const double *q, double *workspace,
                                mr_transform *frames) {
    IN_OUR_ENVIRONMENT(mr_do_forward_kinematics(model, q, workspace, frames));
}

mr_status mr_command(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                     double t, const double *q, const double *dq, const double *q_des,
                     const double *dq_des, const double *ddq_des, double *workspace,
                     mr_controller_state *state, mr_command_out *out) {
    IN_OUR_ENVIRONMENT(mr_do_command(model, bounds, gains, t, q, dq, q_des, dq_des, ddq_des,
                                     workspace, state, out));
}

mr_status mr_loop_advance(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                          const mr_parameters *true_parameters, int32_t count, const double *q_des,
                          const double *dq_des, const double *ddq_des, int32_t log_every,
                          double *workspace, mr_controller_state *state, mr_loop *loop,
                          mr_loop_log *log, int32_t *logged) {
    IN_OUR_ENVIRONMENT(mr_do_loop_advance(model, bounds, gains, true_parameters, count, q_des,
                                          dq_des, ddq_des, log_every, workspace, state, loop, log,
                                          logged));
}

mr_status mr_tracking_error(const mr_model *model, const double *q, const double *q_des,
                            double *error) {
    IN_OUR_ENVIRONMENT(mr_do_tracking_error(model, q, q_des, error));
}

void mr_sincos(double x, double *sine, double *cosine) {
    const mr_environment caller = mr_enter();
    mr_do_sincos(x, sine, cosine);
    mr_leave(caller);
}
