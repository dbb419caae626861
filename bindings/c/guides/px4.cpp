// A PX4 module: spikes of the vehicle's three turn rates out of a serial device.
//
// `spikewire emit c --flight px4.toml -o spikes` makes both ends of px4.toml beside this file, as the library's README shows:
// a header, px4.h, and an archive. The file has 800 samples a second: set IMU_GYRO_RATEMAX to 800. The module stays outside PX4's
// tree, in a directory DIR: this file as DIR/src/modules/spikes/Spikes.cpp, beside it CMakeLists.txt
//
//     find_package(spikewire CONFIG REQUIRED PATHS ${SPIKEWIRE})
//     px4_add_module(MODULE modules__spikes MAIN spikes SRCS Spikes.cpp)
//     target_link_libraries(modules__spikes PRIVATE spikewire::spikewire)
//
// and in DIR/src/CMakeLists.txt the line `set(config_module_list_external modules/spikes PARENT_SCOPE)`. Then, in PX4's tree,
// `make px4_fmu-v6c EXTERNAL_MODULES_LOCATION=DIR CMAKE_ARGS=-DSPIKEWIRE=LIBRARY`, where LIBRARY is target/c-library/cortex-m7
// of spikewire with the header and the archive of px4.toml in place of its own, and `spikes start` in the shell or in rc.txt.
// ModuleBase is that since 19 February 2026, without a template, whose descriptor holds the instance. `spikewire listen --flight
// px4.toml` reads what arrives.

#include <fcntl.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include <px4_platform_common/log.h>
#include <px4_platform_common/module.h>
#include <px4_platform_common/px4_work_queue/ScheduledWorkItem.hpp>
#include <uORB/SubscriptionCallback.hpp>
#include <uORB/topics/vehicle_angular_velocity.h>

#include "px4.h"

class Spikes : public ModuleBase, public px4::ScheduledWorkItem
{
public:
	static Descriptor descriptor;

	Spikes() : ScheduledWorkItem("spikes", px4::wq_configurations::rate_ctrl) {}

	~Spikes() override
	{
		_rates.unregisterCallback();

		if (_fd >= 0) {
			(void)::close(_fd);
		}
	}

	static int task_spawn(int, char **)
	{
		Spikes *instance = new Spikes();

		if (instance == nullptr) {
			return PX4_ERROR;
		}

		descriptor.object.store(instance);
		descriptor.task_id = task_id_is_work_queue;

		if (instance->init()) {
			return PX4_OK;
		}

		delete instance;
		descriptor.object.store(nullptr);
		descriptor.task_id = -1;
		return PX4_ERROR;
	}

	static int custom_command(int, char **) { return print_usage("unknown command"); }

	static int print_usage(const char *reason = nullptr)
	{
		if (reason != nullptr) {
			PX4_WARN("%s", reason);
		}

		return 0;
	}

	bool init()
	{
		sw_status status = sw_px4_bank_start(&_bank);

		if (status == SW_OK) {
			status = sw_queue_init(&_queue, _storage, sizeof(_storage));
		}

		if (status != SW_OK) {
			PX4_ERR("%s", sw_status_text(status));
			return false;
		}

		_fd = ::open("/dev/ttyS3", O_WRONLY | O_NOCTTY | O_NONBLOCK); // TELEM2 of px4_fmu-v6c
		struct termios settings;

		if ((_fd < 0) || (::tcgetattr(_fd, &settings) != 0)) {
			PX4_ERR("no serial device");
			return false;
		}

		::cfmakeraw(&settings); // each byte as it is, lines or not
		::cfsetspeed(&settings, B921600);
		return (::tcsetattr(_fd, TCSANOW, &settings) == 0) && _rates.registerCallback();
	}

private:
	void Run() override
	{
		vehicle_angular_velocity_s rates;

		if (should_exit()) {
			_rates.unregisterCallback();
			exit_and_cleanup(descriptor);
			return;
		}

		if (!_rates.update(&rates)) {
			return;
		}

		// The noise of 64 samples is the session, as no other start has it.
		if (_sample < 64) {
			uint32_t bits;
			memcpy(&bits, &rates.xyz[_sample % SW_PX4_CHANNELS], sizeof(bits));
			_session = (_session ^ bits) * 0x9E3779B97F4A7C15u;

			if (++_sample == 64) {
				(void)sw_px4_writer_init(&_writer, _session);
				_sample = SW_PX4_KEYFRAME_EVERY * 64; // a keyframe comes first
			}

			return;
		}

		const uint32_t now = static_cast<uint32_t>(rates.timestamp_sample);
		(void)sw_px4_bank_encode(&_bank, now, rates.xyz, &_queue);

		if (_sample++ % SW_PX4_KEYFRAME_EVERY == 0) {
			(void)sw_px4_bank_keyframes(&_bank, now, &_queue);
		}

		uint8_t frame[SW_MAX_FRAME];
		size_t length = 0;
		(void)sw_writer_observe(&_writer, now);

		if (sw_writer_next_frame(&_writer, &_queue, frame, sizeof(frame), &length) == SW_OK) {
			// What the device does not take is lost to the reader, which counts it.
			(void)!::write(_fd, frame, length);
		}
	}

	uORB::SubscriptionCallbackWorkItem _rates{this, ORB_ID(vehicle_angular_velocity)};
	sw_px4_bank _bank{};
	uintptr_t _storage[SW_QUEUE_WORDS(128)] {};
	sw_queue _queue{};
	sw_writer _writer{};
	uint64_t _session{0};
	uint32_t _sample{0};
	int _fd{-1};
};

ModuleBase::Descriptor Spikes::descriptor{Spikes::task_spawn, Spikes::custom_command, Spikes::print_usage};

extern "C" __EXPORT int spikes_main(int argc, char *argv[])
{
	return ModuleBase::main(Spikes::descriptor, argc, argv);
}
