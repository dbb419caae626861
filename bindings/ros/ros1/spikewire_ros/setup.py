"""Where catkin finds the Python package; not for use by hand."""

from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=["spikewire_ros"], package_dir={"": "src"}))
