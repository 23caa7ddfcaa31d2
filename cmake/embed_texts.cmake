# cmake -DFOLDER=shaders -DOUTPUT=FILE -DTABLE=embedded_shaders -DHEADER=gl/embedded_shaders.h -DNAMESPACE=radiafit
# -P embed_texts.cmake: all texts of the folder as one C++ table (src/core/base/embedded_text.h).
file(GLOB_RECURSE files RELATIVE ${FOLDER} ${FOLDER}/*)
list(SORT files)
set(table "#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\n\nconst std::vector<EmbeddedText>& ${TABLE}() {\n")
string(APPEND table "    static const std::vector<EmbeddedText> all = {\n")
foreach(file IN LISTS files)
  file(READ ${FOLDER}/${file} text)
  string(APPEND table "        {\"${file}\", R\"text(${text})text\"},\n")
endforeach()
string(APPEND table "    };\n    return all;\n}\n\n}  // namespace ${NAMESPACE}\n")
file(WRITE ${OUTPUT} "${table}")
