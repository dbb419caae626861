//! The node that encodes all channels of a flight.

fn main() -> std::process::ExitCode {
    spikewire_ros::run(spikewire_ros::Kind::Flight)
}
