// Reads steps, a line each with the numbers of the inputs that fire, and prints the outputs that do, and the bits of
// their potentials after the last one. `cargo verify network` compares them with those of `trained`.

#include "network.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(void) {
    char line[4096];
    void *state = malloc(network_size());
    if (!state || !network_is_intact()) return 1;
    network_reset(state);
    while (fgets(line, sizeof line, stdin)) {
        uint16_t inputs[1024];
        const uint16_t *fired;
        size_t count = 0;
        for (char *word = strtok(line, " \n"); word && count < 1024; word = strtok(NULL, " \n"))
            inputs[count++] = (uint16_t)atoi(word);
        size_t outputs = network_step(state, inputs, count, &fired);
        for (size_t at = 0; at < outputs; at++) printf("%d ", fired[at]);
        printf("\n");
    }
    const uint32_t *bits = network_values(state);
    for (size_t at = 0; at < NETWORK_OUTPUTS; at++) printf("%08x ", (unsigned)bits[at]);
    printf("\n");
    free(state);
}
