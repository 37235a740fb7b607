"""Package `cablemodel_ros`: built by colcon (ament_python) or installed by pip."""

from setuptools import find_packages, setup

NAME = "cablemodel_ros"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(include=[NAME, f"{NAME}.*"]),
    package_data={NAME: ["fastdds.xml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", ["launch/cable.launch.py"]),
        (f"share/{NAME}/config", ["config/cable.yaml"]),
        (f"share/{NAME}/rviz", ["rviz/cable.rviz"]),
        (f"share/{NAME}/scenes", ["scenes/waypoint_tow.yaml"]),
    ],
    python_requires=">=3.11",
    install_requires=["setuptools", "cablemodel"],
    # rclpy comes with ROS 2 on a robot; elsewhere the wheels of PyPI do.
    extras_require={
        "wheels": ["ros-jazzy-rclpy[fastrtps]==7.1.6", "ros-jazzy-common-interfaces==5.3.6"],
        "colcon": ["colcon-common-extensions>=0.3,<0.4", "ros-jazzy-ament-package==0.16.4"],
    },
    zip_safe=True,
    description="ROS 2 node of cablemodel, an ocean-cable simulator",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            f"cable = {NAME}.node:main",
        ]
    },
)
