# What the static library needs.
find_dependency(OpenCV COMPONENTS core imgproc calib3d objdetect dnn)
find_dependency(JPEG)
find_dependency(PNG)
find_dependency(TIFF)
find_dependency(yaml-cpp)
find_dependency(pugixml)
find_dependency(fmt)
