# What the static library needs.
find_dependency(OpenCV COMPONENTS core imgproc features2d video calib3d)
find_dependency(fmt)
