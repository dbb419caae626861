#pragma once
#include <stdint.h>
#include <stdlib.h>
class ModuleBase
{
public:
	struct Stored {
		void store(ModuleBase *) {}
	};
	struct Descriptor {
		Descriptor(int (*)(int, char **), int (*)(int, char **), int (*)(const char *)) {}
		Stored object;
		int task_id{-1};
	};
	virtual ~ModuleBase() = default;
	static int main(Descriptor &, int, char *[]) { return 0; }
	static void exit_and_cleanup(Descriptor &) {}
	bool should_exit() const { return false; }
	static constexpr int task_id_is_work_queue = -2;
};
