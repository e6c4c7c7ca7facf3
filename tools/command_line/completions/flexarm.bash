# Completion of flexarm and flexarmd in bash: the programs say what may follow.
_flexarm() {
  local current=${COMP_WORDS[COMP_CWORD]} answer word
  answer=$("${COMP_WORDS[0]}" --complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null) || return
  [[ $current == "=" ]] && current=""
  COMPREPLY=()
  while IFS= read -r word; do
    case $word in
      "") ;;
      :files)
        compopt -o filenames
        while IFS= read -r word; do COMPREPLY+=("$word"); done < <(compgen -f -- "$current")
        ;;
      :folders)
        compopt -o filenames
        while IFS= read -r word; do COMPREPLY+=("$word"); done < <(compgen -d -- "$current")
        ;;
      *=)
        compopt -o nospace
        COMPREPLY+=("$word")
        ;;
      *) COMPREPLY+=("$word") ;;
    esac
  done <<<"$answer"
}
complete -F _flexarm flexarm flexarmd flexarm-study flexarm-web
