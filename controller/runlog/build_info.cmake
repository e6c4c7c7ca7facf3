# Writes build_info_generated.h; run at every build, touches the file only when it changes.
# Variables: OUTPUT SOURCE_DIR VERSION COMPILER FLAGS
set(hash "unknown")
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} --no-optional-locks describe --always --dirty --abbrev=12 --exclude=*
    WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE described RESULT_VARIABLE failed
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed AND described)
    set(hash "${described}")
  endif()
endif()
string(MD5 flags_hash "${FLAGS}")
string(SUBSTRING "${flags_hash}" 0 8 flags_hash)
set(text "#pragma once
#define FLEXARM_VERSION \"${VERSION}\"
#define FLEXARM_GIT_HASH \"${hash}\"
#define FLEXARM_COMPILER \"${COMPILER}\"
#define FLEXARM_FLAGS_HASH \"${flags_hash}\"
")
set(previous "")
if(EXISTS "${OUTPUT}")
  file(READ "${OUTPUT}" previous)
endif()
if(NOT previous STREQUAL text)
  file(WRITE "${OUTPUT}" "${text}")
endif()
