#pragma once
#include <px4_platform_common/px4_work_queue/ScheduledWorkItem.hpp>
#define ORB_ID(name) nullptr
namespace uORB
{
class SubscriptionCallbackWorkItem
{
public:
	SubscriptionCallbackWorkItem(px4::ScheduledWorkItem *, const void *) {}
	bool registerCallback() { return true; }
	void unregisterCallback() {}
	bool update(void *) { return true; }
};
}
