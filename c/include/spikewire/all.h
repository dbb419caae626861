/* Every codec. */
#ifndef SPIKEWIRE_ALL_H
#define SPIKEWIRE_ALL_H

#include "adaptive_contrast.h"
#include "adaptive_step_forward.h"
#include "bsa_24.h"
#include "bsa_toolbox_9.h"
#include "burst_19.h"
#include "first_spike_16.h"
#include "gaussian_20.h"
#include "hough_15.h"
#include "integrate_and_fire_8.h"
#include "latency_phase_4_32_4.h"
#include "leaky_integrate_and_fire_8.h"
#include "moving_window_6.h"
#include "non_linear_gaussian_20.h"
#include "non_linear_slots_15_10.h"
#include "position_20.h"
#include "rank_order_15_3.h"
#include "send_on_delta_4.h"
#include "sigma_delta.h"
#include "sigma_delta_window_2.h"
#include "slots_15_10.h"
#include "step_forward.h"
#include "temporal_contrast.h"
#include "threshold_hough_15.h"
#include "weighted_burst.h"
#include "weighted_phase_8.h"

#endif
