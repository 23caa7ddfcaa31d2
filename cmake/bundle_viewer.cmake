# cmake -DSOURCE=web -DOUTPUT=FOLDER -DNODE=node -DNPM=npm -P bundle_viewer.cmake: what a published page is made of, in
# OUTPUT/page: index.html, style.css and viewer.js, which is web/src with what it takes of npm's packages. `npm ci` runs only
# where package-lock.json changed. Without node, or where packages can't be had, viewer.js is empty, which `radiafit publish`
# tells, and how to mend it. Packages are tried again by the next build, since OUTPUT/built is missing; node, once CMake finds it.
file(MAKE_DIRECTORY ${OUTPUT}/page)
file(REMOVE ${OUTPUT}/built)
foreach(file index.html style.css)
  file(COPY_FILE ${SOURCE}/${file} ${OUTPUT}/page/${file} ONLY_IF_DIFFERENT)
endforeach()

if(NOT EXISTS ${OUTPUT}/page/viewer.js)
  file(WRITE ${OUTPUT}/page/viewer.js "")
endif()
if(NOT NODE OR NOT NPM)
  file(WRITE ${OUTPUT}/built "")
  return()
endif()

file(SHA256 ${SOURCE}/package-lock.json lock)
set(installed "")
if(EXISTS ${OUTPUT}/installed)
  file(READ ${OUTPUT}/installed installed)
endif()
if(NOT installed STREQUAL lock)
  file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json DESTINATION ${OUTPUT})
  execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error WORKING_DIRECTORY ${OUTPUT}
                  RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said TIMEOUT 600)
  if(failed)
    message(NOTICE "`npm ci` failed: radiafit is built without the viewer of `radiafit publish`\n${said}")
    return()
  endif()
  file(WRITE ${OUTPUT}/installed ${lock})
endif()

execute_process(COMMAND ${CMAKE_COMMAND} -E env NODE_PATH=${OUTPUT}/node_modules
                        ${OUTPUT}/node_modules/.bin/esbuild ${SOURCE}/src/main.js --bundle --minify --format=iife
                        --target=es2020 --legal-comments=inline --charset=ascii --log-level=warning
                        --outfile=${OUTPUT}/page/viewer.js
                RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "web/src cannot be bundled")
endif()
file(WRITE ${OUTPUT}/built "")
