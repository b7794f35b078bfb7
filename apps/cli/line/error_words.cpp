#include "cli/line/error_words.h"

#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

#include "cli/line/flags.h"
#include "cli/line/suggestions.h"

namespace sansmesh::cli {

std::string words_of_file_error(const FileError& error, const CommandLine& command) {
  std::string message = in_flags(error.what(), command);
  std::error_code ignored;
  if (std::filesystem::exists(error.file(), ignored)) return message;
  for (const std::string cause : {": cannot be opened", ": cannot be read"})
    if (message.ends_with(cause)) message.replace(message.size() - cause.size(), cause.size(), ": no such file");
  if (command.has("--" + error.file().substr(0, error.file().find('='))))
    return message + " (did you mean --" + error.file() + "?)";
  for (const char* const cause :
       {": no such file", ": does not exist", ": folder does not exist", ": no function file"})
    if (message.find(cause) != std::string::npos) {
      const std::string listed = did_you_mean_listed(message, error.file());
      return message + (listed.empty() ? did_you_mean_file(error.file()) : listed);
    }
  return message;
}

std::string words_of_error(const std::exception& error) {
  if (dynamic_cast<const Error*>(&error)) return error.what();
  if (dynamic_cast<const std::bad_alloc*>(&error) || dynamic_cast<const std::length_error*>(&error))
    return "not enough memory";
  if (const auto* of_file = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
    return of_file->path1().string() + ": cannot be used (" + of_file->code().message() + ")";
  if (const auto* of_system = dynamic_cast<const std::system_error*>(&error))
    return "the system refuses a resource (" + of_system->code().message() + ")";
  return std::string("internal error of sansmesh, please report it (") + error.what() + ")";
}

}  // namespace sansmesh::cli
