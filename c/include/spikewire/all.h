/* Every codec. */
#ifndef SPIKEWIRE_ALL_H
#define SPIKEWIRE_ALL_H

#include "temporal_contrast.h"
#include "adaptive_contrast.h"
#include "moving_window_6.h"
#include "step_forward.h"
#include "send_on_delta_4.h"
#include "adaptive_step_forward.h"
#include "bsa_24.h"
#include "bsa_toolbox_9.h"
#include "hough_15.h"
#include "threshold_hough_15.h"
#include "integrate_and_fire_8.h"
#include "leaky_integrate_and_fire_8.h"
#include "sigma_delta.h"
#include "sigma_delta_window_2.h"
#include "weighted_burst.h"
#include "position_20.h"
#include "gaussian_20.h"
#include "slots_15_10.h"
#include "non_linear_gaussian_20.h"
#include "non_linear_slots_15_10.h"
#include "rank_order_15_3.h"
#include "first_spike_16.h"
#include "latency_phase_4_32_4.h"
#include "weighted_phase_8.h"
#include "burst_19.h"

#endif
