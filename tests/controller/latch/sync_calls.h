#pragma once

namespace flexarm {

/// Calls of syncfs by this program so far.
extern int file_systems_synced;

/// While it lives, every fsync of a folder fails, as on a broken disk; that of a file does not.
class FoldersFailToSync {
 public:
  FoldersFailToSync();
  ~FoldersFailToSync();
  FoldersFailToSync(const FoldersFailToSync&) = delete;
  FoldersFailToSync& operator=(const FoldersFailToSync&) = delete;
};

}  // namespace flexarm
