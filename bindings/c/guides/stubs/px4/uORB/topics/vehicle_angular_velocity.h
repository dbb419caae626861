#pragma once
#include <stdint.h>
struct vehicle_angular_velocity_s {
	uint64_t timestamp;
	uint64_t timestamp_sample;
	float xyz[3];
};
