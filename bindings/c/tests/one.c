/* One codec on the host, by the package. */
#include "spikewire/step_forward.h"

int main(void)
{
    static sw_step_forward_f32 codec;
    static sw_step_forward_f32_encoder encoder;
    int8_t spike = 0;
    sw_status status = sw_step_forward_f32_init(&codec, 0.35f, NULL);

    if (status == SW_OK) {
        status = sw_step_forward_f32_encoder_start(&encoder, &codec);
    }
    if (status == SW_OK) {
        status = sw_step_forward_f32_encode(&encoder, 1.0f, &spike);
    }
    if (status == SW_OK) {
        status = sw_step_forward_f32_encode(&encoder, 2.0f, &spike);
    }
    return ((status == SW_OK) && (spike == 1)) ? 0 : 1;
}
