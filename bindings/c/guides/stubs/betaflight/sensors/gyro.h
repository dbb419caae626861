#pragma once
typedef struct gyro_s {
    float gyroADCf[3];
} gyro_t;
extern gyro_t gyro;
