#pragma once
#include <stddef.h>
#define APPCHANNEL_MTU (30)
int appchannelSendDataPacket(void *data, size_t length);
