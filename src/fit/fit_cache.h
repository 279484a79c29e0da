#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "fit/primitive_fit.h"

namespace tccm {

/// Part of every fit's identity. To be raised whenever the fitting, the reading of meshes or the
/// form of the cache's files changes.
constexpr int kFitCacheVersion = 2;

/// Remembers fits by what they were made from: in this process, and where there is a folder, in one
/// small file each for processes to come. What is damaged, foreign or of another version is
/// computed anew. Safe to use from several threads, and by several processes with one folder.
class FitCache {
 public:
  /// @param folder made when something is first saved; empty: no files.
  explicit FitCache(std::string folder) : folder_(std::move(folder)) {}

  /// The fit of that mesh, computed only where it is not known yet; equal to the computed one to
  /// the bit. What compute throws passes through, and nothing is remembered then.
  /// @param key everything besides the content that determines the fit, such as the file's
  /// extension, its scale and the fit's configuration.
  /// @param compute must not use this cache.
  [[nodiscard]] PrimitiveFit fit(const std::string& mesh_content, const std::string& key,
                                 const std::function<PrimitiveFit()>& compute);

  /// Why a fit could not be saved, in one line; empty where all could.
  [[nodiscard]] std::string saveProblem() const;

 private:
  const std::string folder_;
  mutable std::mutex mutex_;
  std::map<std::string, PrimitiveFit> known_;  ///< by identity
  std::string save_problem_;
};

}  // namespace tccm
