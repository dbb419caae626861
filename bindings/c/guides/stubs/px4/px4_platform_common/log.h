#pragma once
#define __EXPORT
#define PX4_OK 0
#define PX4_ERROR (-1)
void px4_log(const char *format, ...);
#define PX4_WARN px4_log
#define PX4_ERR px4_log
