/* One robust command at each of a few states, for counting instructions; see test_instructions.py.
 *
 * command_data.h is written by instruction_counts.py. The only argument is the number of rounds:
 * the difference between two runs is what the rounds in between cost, and nothing else. */
#include <stdlib.h>

#include "command_data.h"

int main(int count, char **arguments) {
    const long rounds = count > 1 ? strtol(arguments[1], NULL, 10) : 1;
    mr_model model = command_model;
    mr_bounds bounds = command_bounds;
    double *precomputed = malloc(mr_precomputed_size(&model) * sizeof *precomputed);
    mr_precompute_model(&model, precomputed);
    model.precomputed = precomputed;
    double *prepared = malloc(mr_prepared_size(&model) * sizeof *prepared);
    mr_prepare(&model, &bounds, prepared);
    bounds.prepared = prepared;
    double *work = malloc(mr_command_workspace_size(&model) * sizeof *work);
    double *memory = malloc(mr_controller_memory_size(&model) * sizeof *memory);
    double out[6][JOINTS];
    mr_command_out answer = {.tau = out[0],
                             .nominal = out[1],
                             .v = out[2],
                             .phi_lo = out[3],
                             .phi_hi = out[4],
                             .rho = out[5]};
    for (long round = 0; round < rounds; ++round) {
        mr_controller_state state = {.memory = memory};
        for (int k = 0; k < STATES; ++k)
            if (mr_command(&model, &bounds, &command_gains, 1e-3 * k, signals[k][0], signals[k][1],
                           signals[k][2], signals[k][3], signals[k][4], work, &state, &answer))
                return 1;
    }
    return 0;
}
