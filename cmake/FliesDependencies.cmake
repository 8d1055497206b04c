# Everything flies links, all from the distribution. Shared by the build and by the installed package.
find_package(fmt REQUIRED)
find_package(TBB REQUIRED)
find_package(hwy REQUIRED)
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc imgcodecs calib3d objdetect dnn)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(pugixml REQUIRED)
find_package(embree 3 REQUIRED)
