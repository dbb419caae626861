//! The node that encodes.

fn main() -> std::process::ExitCode {
    spikewire_ros::run(spikewire_ros::Kind::Encode)
}
