#pragma once
#include <stddef.h>
#define APPCHANNEL_MTU 31u
void appchannelSendDataPacketBlock(void *data, size_t length);
