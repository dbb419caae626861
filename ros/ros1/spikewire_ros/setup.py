"""Where catkin finds the Python package; not for use by hand."""

from setuptools import setup

from catkin_pkg.python_setup import generate_distutils_setup

setup(**generate_distutils_setup(packages=["spikewire_ros"], package_dir={"": "src"}))
