//! The node that decodes.

fn main() -> std::process::ExitCode {
    spikewire_ros::run(spikewire_ros::Kind::Decode)
}
