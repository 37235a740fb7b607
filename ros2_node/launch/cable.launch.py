"""Start the node `cable`, configure and activate it; RViz on request.

ros2 launch cablemodel_ros cable.launch.py scene:=/path/to/scene.yaml rviz:=true namespace:=tug
"""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LifecycleNode, Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description() -> LaunchDescription:
    """Arguments: see below. RViz is in the node's namespace: its topics are relative to that."""
    share = Path(get_package_share_directory("cablemodel_ros"))
    arguments = [
        DeclareLaunchArgument("scene", default_value=str(share / "scenes/waypoint_tow.yaml")),
        DeclareLaunchArgument("config", default_value=str(share / "config/cable.yaml")),
        DeclareLaunchArgument("namespace", default_value=""),
        DeclareLaunchArgument("use_sim_time", default_value="false"),
        DeclareLaunchArgument("on_failure", default_value="stay"),
        DeclareLaunchArgument("respawn", default_value="false"),  # with on_failure:=exit
        DeclareLaunchArgument("rviz", default_value="false"),
    ]
    use_sim_time = ParameterValue(LaunchConfiguration("use_sim_time"), value_type=bool)
    cable = LifecycleNode(
        package="cablemodel_ros",
        executable="cable",
        name="cable",
        namespace=LaunchConfiguration("namespace"),
        output="screen",
        respawn=LaunchConfiguration("respawn"),
        respawn_delay=2.0,
        parameters=[
            LaunchConfiguration("config"),
            {
                "scene": ParameterValue(LaunchConfiguration("scene"), value_type=str),
                "use_sim_time": use_sim_time,
                "on_failure": ParameterValue(LaunchConfiguration("on_failure"), value_type=str),
                "autostart": True,
            },
        ],
    )
    rviz = Node(
        package="rviz2",
        executable="rviz2",
        namespace=LaunchConfiguration("namespace"),
        arguments=["-d", str(share / "rviz/cable.rviz")],
        parameters=[{"use_sim_time": use_sim_time}],
        condition=IfCondition(LaunchConfiguration("rviz")),
    )
    return LaunchDescription([*arguments, cable, rviz])
