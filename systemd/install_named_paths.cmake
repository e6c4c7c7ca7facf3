# Run by the installation: writes the files that name installed paths. The prefix is known only then:
# `cmake --install --prefix` and cpack choose another one than the build folder's.
# Variables: FROM, the folder of this file; PROJECT_NAME; CMAKE_INSTALL_*DIR
include(GNUInstallDirs)  # makes CMAKE_INSTALL_FULL_*DIR of this prefix

function(install_configured name folder)
  set(made "$ENV{DESTDIR}${folder}/${name}")
  configure_file("${FROM}/${name}.in" "${made}" @ONLY)
  message(STATUS "Installing: ${made}")
endfunction()

install_configured(flexarmd.service "${CMAKE_INSTALL_PREFIX}/lib/systemd/system")

# The config of this machine.
set(rig "$ENV{DESTDIR}${CMAKE_INSTALL_FULL_SYSCONFDIR}/flexarm/rig.toml")
if(EXISTS "${rig}")
  message(STATUS "Kept: ${rig}")
else()
  install_configured(rig.toml "${CMAKE_INSTALL_FULL_SYSCONFDIR}/flexarm")
endif()

# The pages name configs by their path in the sources.
set(pages "${CMAKE_INSTALL_FULL_DOCDIR}")
file(RELATIVE_PATH configs "${pages}" "${CMAKE_INSTALL_FULL_DATADIR}/flexarm/config")
file(CREATE_LINK "${configs}" "$ENV{DESTDIR}${pages}/config" SYMBOLIC)
