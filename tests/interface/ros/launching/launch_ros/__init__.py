"""As `launch_ros`, as far as launching/launch says."""
