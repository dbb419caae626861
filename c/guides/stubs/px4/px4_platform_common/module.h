#pragma once
#include <stdint.h>
uint64_t hrt_absolute_time();
template<class T> struct Stored {
	void store(T *) {}
};
template<class T> class ModuleBase
{
public:
	virtual ~ModuleBase() = default;
	static int main(int argc, char *argv[]) { return T::task_spawn(argc, argv); }
	bool should_exit() const { return false; }
	void exit_and_cleanup() {}
	static Stored<T> _object;
	static int _task_id;
	static constexpr int task_id_is_work_queue = -2;
};
template<class T> Stored<T> ModuleBase<T>::_object;
template<class T> int ModuleBase<T>::_task_id = -1;
