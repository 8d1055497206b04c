#include "flies/core/error.hpp"
#include "flies/io/number_table.hpp"
#include "flies/io/options_yaml.hpp"
#include "tests/fuzz/target.hpp"

// Tables of numbers, behind all calibration formats, and options.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    flies::parse_number_table(text, "input");
  } catch (const flies::InputError&) {
  }
  try {
    flies::parse_options_yaml(text, "input");
  } catch (const flies::InputError&) {
  }
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  return {
      "P2: 700 0 600 0 0 700 170 0 0 0 1 0\nP3: 700 0 600 -280 0 700 170 0 0 0 1 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n",
      "fx_px: 700\ncx_px: 600\ncy_px: 170\nbaseline_m: 0.5\nwidth_px: 1242\nheight_px: 375\n",
      "cam0=[700 0 600; 0 700 170; 0 0 1]\ncam1=[700 0 600; 0 700 170; 0 0 1]\nbaseline=100\nwidth=9\nheight=9\n",
      "%YAML:1.0\n---\nP1: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n   data: [ 500., 0., 320., 0. ]\n",
      "<?xml version=\"1.0\"?>\n<opencv_storage><P1 type_id=\"opencv-matrix\"><rows>1</rows><cols>2</cols><dt>d</dt>"
      "<data>1. 2.</data></P1></opencv_storage>\n",
      "[LEFT_CAM_HD]\nfx=700\nfy=700\n[STEREO]\nBaseline=120\nRX_HD=0.1\n",
      "754 0 489 0 754 265 0 0 1\n0.063\n",
      "{\"value0\": {\"T_imu_cam\": [{\"px\": 1, \"qw\": 1}], \"intrinsics\": [{\"camera_type\": \"ds\", "
      "\"intrinsics\": "
      "{\"fx\": 3}}], \"resolution\": [[752, 480], [752, 480]]}}",
      "seed: 3\nevolve:\n  flies: 5000\n  initial: image\nroad.estimate: false\n",
      "a: &a [[],[],[],[]]\nb: &b [*a,*a,*a,*a]\nc: &c [*b,*b,*b,*b]\nd: [*c,*c,*c,*c]\n"};
}
