#include <spikewire.h>
#include <spikewire/step_forward.h>

static sw_step_forward_f32 roll;
static sw_step_forward_f32_encoder encoder;

void setup() {
  Serial.begin(115200);
  sw_step_forward_f32_init(&roll, 20.0f, nullptr);
  sw_step_forward_f32_encoder_start(&encoder, &roll);
}

void loop() {
  int8_t spike;
  sw_step_forward_f32_encode(&encoder, analogRead(A0), &spike);
  if (spike != 0) Serial.println(spike);
  delay(1);
}
