// Loads the OpenCV libraries that `flies` is linked with, and ends: bench/report takes the time of that.
int main() {}
