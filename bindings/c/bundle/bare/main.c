#include "board.h"
#include <spikewire/step_forward.h>

int main(void)
{
    static const float samples[] = {0.0f, 0.2f, 0.6f, 1.2f, 1.3f, 0.4f};
    static sw_step_forward_f32 roll;
    static sw_step_forward_f32_encoder encoder;
    int8_t spike;

    sw_step_forward_f32_init(&roll, 0.5f, NULL);
    sw_step_forward_f32_encoder_start(&encoder, &roll);
    for (unsigned i = 0; i < sizeof samples / sizeof samples[0]; i++) {
        sw_step_forward_f32_encode(&encoder, samples[i], &spike);
        board_print(spike > 0 ? "+\n" : spike < 0 ? "-\n" : ".\n");
    }
    board_finish(1);
}
