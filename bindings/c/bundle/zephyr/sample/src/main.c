#include <spikewire/step_forward.h>
#include <zephyr/kernel.h>

int main(void)
{
    static const float samples[] = {0.0f, 0.2f, 0.6f, 1.2f, 1.3f, 0.4f};
    static sw_step_forward_f32 roll;
    static sw_step_forward_f32_encoder encoder;
    int8_t spike;

    sw_step_forward_f32_init(&roll, 0.5f, NULL);
    sw_step_forward_f32_encoder_start(&encoder, &roll);
    for (size_t i = 0; i < ARRAY_SIZE(samples); i++) {
        sw_step_forward_f32_encode(&encoder, samples[i], &spike);
        printk("%d\n", spike);
    }
    return 0;
}
