// Models in files; apart from their text, which needs no file.
#include "flies/classify/model_file.hpp"
#include "flies/io/output_file.hpp"
#include "flies/io/text_file.hpp"

namespace flies {

PeopleModel read_people_model(const std::string& path) {
  return parse_people_model(read_file(path, kMaxModelFile_bytes), path);
}

void write_people_model(const std::string& path, const PeopleModel& model) {
  write_file(path, people_model_text(model));
}

}  // namespace flies
