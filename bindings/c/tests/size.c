/* What a codec adds to a program: its initialisation, and both directions in the sample form. Linked, not run. */
#include "board.h"
#include "spikewire/all.h"

typedef void (*function)(void);

#define USED(name) USED_(name)
#define USED_(name) (function)sw_##name##_encoder_start, (function)sw_##name##_encode, (function)sw_##name##_decoder_start, (function)sw_##name##_decode
#define INIT(name, init) INIT_(name, init)
#define INIT_(name, init) (function)sw_##name##_##init

const function used[] = {
#if defined(CODEC)
    INIT(CODEC, MAKE), USED(CODEC),
#endif
    0};

int main(void)
{
    for (const function *volatile each = used; *each != 0; ++each) {
        (*each)();
    }
    return 0;
}
