#pragma once
namespace px4
{
struct wq_config_t {
	const char *name;
};
namespace wq_configurations
{
static constexpr wq_config_t rate_ctrl{"wq:rate_ctrl"};
}
class ScheduledWorkItem
{
public:
	ScheduledWorkItem(const char *, const wq_config_t &) {}
	virtual ~ScheduledWorkItem() = default;
	virtual void Run() = 0;
};
}
